#include "pack/orient.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace partuv::packing {

Vec2 turned_size(const std::vector<Vec2>& hull, double rotation_rad) {
  if (hull.empty()) return Vec2::Zero();
  const double c = std::cos(rotation_rad);
  const double s = std::sin(rotation_rad);
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);
  for (const Vec2& p : hull) {
    const Vec2 turned(c * p.x() - s * p.y(), s * p.x() + c * p.y());
    low = low.cwiseMin(turned);
    high = high.cwiseMax(turned);
  }
  return high - low;
}

Orientation least_rectangle(const std::vector<Vec2>& hull) {
  // The smallest rectangle has a side along an edge of the hull (Freeman and Shapira 1975).
  // Calipers walk round with the edges, so that all edges together cost O(H).
  Orientation best;
  best.size = turned_size(hull, 0.0);
  const size_t count = hull.size();
  if (count == 2) {
    const Vec2 along = hull[1] - hull[0];
    best.rotation_rad = -std::atan2(along.y(), along.x());
    best.size = Vec2(along.norm(), 0.0);
  }
  if (count < 3) return best;
  double least_area = INFINITY;
  size_t right = 0;
  size_t top = 0;
  size_t left = 0;
  for (size_t edge = 0; edge < count; ++edge) {
    const Vec2 x = (hull[(edge + 1) % count] - hull[edge]).normalized();
    const Vec2 y(-x.y(), x.x());
    auto climb = [&](size_t from, const Vec2& direction) {
      size_t at = from;
      for (size_t steps = 0; steps < count; ++steps) {
        const size_t next = (at + 1) % count;
        if (hull[next].dot(direction) < hull[at].dot(direction)) break;
        at = next;
      }
      return at;
    };
    right = climb(edge == 0 ? 0 : right, x);
    top = climb(edge == 0 ? right : top, y);
    left = climb(edge == 0 ? top : left, -x);
    const double width = hull[right].dot(x) - hull[left].dot(x);
    const double height = hull[top].dot(y) - hull[edge].dot(y);
    if (width * height < least_area) {
      least_area = width * height;
      best.rotation_rad = -std::atan2(x.y(), x.x());
      if (width < height) best.rotation_rad += 0.5 * std::numbers::pi;
      best.size = Vec2(std::max(width, height), std::min(width, height));
    }
  }
  return best;
}

Orientation least_square(const std::vector<Vec2>& hull) {
  // The longer side as a function of the angle is continuous with few dips within a quarter turn:
  // sample it, then narrow the best dip by golden section.
  constexpr int samples = 180;
  const double step = 0.5 * std::numbers::pi / samples;
  auto side = [&](double angle) { return turned_size(hull, angle).maxCoeff(); };
  int best = 0;
  double least = side(0.0);
  for (int i = 1; i < samples; ++i) {
    const double value = side(i * step);
    if (value < least) {
      least = value;
      best = i;
    }
  }
  double from = (best - 1) * step;
  double to = (best + 1) * step;
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int i = 0; i < 40; ++i) {
    const double one = to - ratio * (to - from);
    const double two = from + ratio * (to - from);
    (side(one) <= side(two) ? to : from) = side(one) <= side(two) ? two : one;
  }
  Orientation result;
  result.rotation_rad = 0.5 * (from + to);
  if (side(result.rotation_rad) > least) result.rotation_rad = best * step;
  result.size = turned_size(hull, result.rotation_rad);
  return result;
}

}  // namespace partuv::packing
