#pragma once

#include <algorithm>
#include <cmath>

#include "partuv/types.hpp"

namespace partuv::packing {

/// A segment grown by a disk, and how far it reaches at given heights.
struct Capsule {
  Vec2 a, b;
  double radius;
  Vec2 normal;         // of length radius, or zero for a point
  double slope = 0.0;  // of x over y, 0 for a level segment

  Capsule(const Vec2& start, const Vec2& stop, double r) : a(start), b(stop), radius(r) {
    const Vec2 along = b - a;
    const double length = along.norm();
    normal = length > 0.0 ? Vec2(-along.y() * (r / length), along.x() * (r / length)) : Vec2(0, 0);
    if (along.y() != 0.0) slope = along.x() / along.y();
  }

  /// Grow [low, high] to the capsule's cut at height y.
  void cut(double y, double& low, double& high) const {
    auto cut_disk = [&](const Vec2& end) {
      const double dy = y - end.y();
      const double rest = radius * radius - dy * dy;
      if (rest < 0.0) return;
      const double half = std::sqrt(rest);
      low = std::min(low, end.x() - half);
      high = std::max(high, end.x() + half);
    };
    auto cut_side = [&](const Vec2& p, double end_y) {
      if ((y < p.y()) == (y < end_y) || p.y() == end_y) return;
      const double x = p.x() + slope * (y - p.y());
      low = std::min(low, x);
      high = std::max(high, x);
    };
    cut_disk(a);
    cut_disk(b);
    cut_side(a - normal, b.y() - normal.y());
    cut_side(a + normal, b.y() + normal.y());
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
