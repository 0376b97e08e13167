#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pack/distance.hpp"
#include "pack/outline.hpp"

namespace partuv::packing {

namespace {

/// Marks the points of an open chain [from, to] that must stay.
void keep_far_points(const std::vector<Vec2>& chain, double tolerance, std::vector<bool>& keep,
                     size_t from, size_t to) {
  std::vector<std::pair<size_t, size_t>> open{{from, to}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    const Segment chord{chain[first], chain[last]};
    double furthest = tolerance;
    size_t at = first;
    for (size_t i = first + 1; i < last; ++i) {
      const double distance = point_distance(chain[i], chord);
      if (distance > furthest) {
        furthest = distance;
        at = i;
      }
    }
    if (at == first) continue;
    keep[at] = true;
    open.emplace_back(first, at);
    open.emplace_back(at, last);
  }
}

struct LoopSize {
  double signed_area = 0.0;
  double width = 0.0;  // shorter side of the bounding box
};

LoopSize measure(const Vec2* points, size_t count) {
  LoopSize size;
  Vec2 low = points[0];
  Vec2 high = points[0];
  for (size_t i = 0; i < count; ++i) {
    const Vec2 p = points[i] - points[0];
    const Vec2 q = points[(i + 1) % count] - points[0];
    size.signed_area += 0.5 * (p.x() * q.y() - p.y() * q.x());
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  size.width = (high - low).minCoeff();
  return size;
}

}  // namespace

Loops simplified(const Loops& loops, double tolerance, double least_hole) {
  Loops result;
  std::vector<Vec2> chain;
  std::vector<bool> keep;
  for (int loop = 0; loop < loops.count(); ++loop) {
    const Vec2* first = &loops.points[loops.start[loop]];
    const size_t count = loops.start[loop + 1] - loops.start[loop];
    const LoopSize size = measure(first, count);
    if (size.signed_area < 0.0 && size.width <= least_hole) continue;
    // Cut the loop at its first point and at the one furthest from it.
    size_t opposite = 0;
    for (size_t i = 1; i < count; ++i) {
      if ((first[i] - first[0]).squaredNorm() > (first[opposite] - first[0]).squaredNorm()) {
        opposite = i;
      }
    }
    chain.assign(first, first + count);
    chain.push_back(first[0]);
    keep.assign(count + 1, false);
    keep[0] = keep[opposite] = true;
    keep_far_points(chain, tolerance, keep, 0, opposite);
    keep_far_points(chain, tolerance, keep, opposite, count);
    for (size_t i = 0; i < count; ++i) {
      if (keep[i]) result.points.push_back(chain[i]);
    }
    result.close();
  }
  return result;
}

Loops reduced(const Outline& outline, double tolerance, double gutter) {
  if (2.0 * outline.radius > gutter) return simplified(outline.loops, tolerance, 2.0 * gutter);
  Loops hull;
  hull.points = outline.hull;
  hull.close();
  return simplified(hull, tolerance, 0.0);
}

}  // namespace partuv::packing
