#pragma once

#include <algorithm>
#include <cmath>

#include "partuv/types.hpp"

namespace partuv::packing {

/// A segment grown by a disk, and how far it reaches at given heights.
struct Capsule {
  Vec2 a, b;
  double radius;
  Vec2 normal;  // of length radius, or zero for a point

  Capsule(const Vec2& start, const Vec2& stop, double r) : a(start), b(stop), radius(r) {
    const Vec2 along = b - a;
    const double length = along.norm();
    normal = length > 0.0 ? Vec2(-along.y() * (r / length), along.x() * (r / length)) : Vec2(0, 0);
  }

  /// Grow [low, high] to the capsule's cut at height y.
  void cut(double y, double& low, double& high) const {
    for (const Vec2& end : {a, b}) {
      const double dy = y - end.y();
      const double rest = radius * radius - dy * dy;
      if (rest < 0.0) continue;
      const double half = std::sqrt(rest);
      low = std::min(low, end.x() - half);
      high = std::max(high, end.x() + half);
    }
    for (const double side : {-1.0, 1.0}) {
      const Vec2 p = a + side * normal;
      const Vec2 q = b + side * normal;
      if ((y < p.y()) == (y < q.y()) || p.y() == q.y()) continue;
      const double x = p.x() + (q.x() - p.x()) * ((y - p.y()) / (q.y() - p.y()));
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }

  /// The capsule's reach in x over heights [y, y + 1]. Its right side is a concave function of the
  /// height with its peak beside the end that lies furthest right (left alike), so three cuts do.
  void reach(double y, double& low, double& high) const {
    const double bottom = std::min(a.y(), b.y()) - radius;
    const double top = std::max(a.y(), b.y()) + radius;
    const double from = std::max(y, bottom);
    const double to = std::min(y + 1.0, top);
    if (from > to) return;
    cut(from, low, high);
    cut(to, low, high);
    for (const Vec2& end : {a, b}) {
      if (end.y() >= from && end.y() <= to) {
        low = std::min(low, end.x() - radius);
        high = std::max(high, end.x() + radius);
      }
    }
  }
};

}  // namespace partuv::packing
