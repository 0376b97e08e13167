#include "pack/outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

namespace partuv::packing {

namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Edge {
  int32_t low, high;  // end points in ascending order
  int32_t way;        // 1 where the triangle runs from low to high, else -1
};

/// The sum of the triangles' boundaries: an edge stays as often as it is used more one way than the
/// other, so that winding numbers count the triangles over a point however they are joined.
std::vector<std::array<int32_t, 2>> boundary_edges(const std::vector<Triangle>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    for (int side = 0; side < 3; ++side) {
      const int32_t start = triangle[side];
      const int32_t stop = triangle[(side + 1) % 3];
      edges.push_back({std::min(start, stop), std::max(start, stop), start < stop ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& one, const Edge& two) {
    return std::tuple(one.low, one.high, one.way) < std::tuple(two.low, two.high, two.way);
  });
  std::vector<std::array<int32_t, 2>> boundary;
  for (size_t first = 0; first < edges.size();) {
    const auto [low, high, way] = edges[first];
    int balance = 0;
    for (; first < edges.size() && edges[first].low == low && edges[first].high == high; ++first) {
      balance += edges[first].way;
    }
    if (low == high) continue;
    for (; balance > 0; --balance) boundary.push_back({low, high});
    for (; balance < 0; ++balance) boundary.push_back({high, low});
  }
  return boundary;
}

/// Point indices of closed walks along all edges. A sum of boundaries enters every point as often
/// as it leaves it, so a walk can only end where it began.
template <typename Place>
void walk_loops(std::vector<std::array<int32_t, 2>> edges, const Place& place, Loops& loops) {
  std::sort(edges.begin(), edges.end());
  std::vector<bool> used(edges.size(), false);
  auto leave = [&](int32_t point) {
    auto at = std::lower_bound(edges.begin(), edges.end(), std::array<int32_t, 2>{point, -1});
    while (at != edges.end() && (*at)[0] == point && used[at - edges.begin()]) ++at;
    return at != edges.end() && (*at)[0] == point ? at - edges.begin() : ptrdiff_t{-1};
  };
  for (size_t first = 0; first < edges.size(); ++first) {
    if (used[first]) continue;
    for (ptrdiff_t at = static_cast<ptrdiff_t>(first); at >= 0; at = leave(edges[at][1])) {
      used[at] = true;
      loops.points.push_back(place(edges[at][0]));
      if (edges[at][1] == edges[first][0]) break;
    }
    loops.close();
  }
}

/// The corners of the triangles; of a chart without any, all points.
std::vector<Vec2> used_points(const PackChart& chart) {
  if (chart.triangles.empty()) return chart.uv;
  std::vector<Vec2> used;
  used.reserve(3 * chart.triangles.size());
  for (const Triangle& triangle : chart.triangles) {
    for (int32_t corner : triangle) used.push_back(chart.uv[corner]);
  }
  return used;
}

Outline make_outline(const PackChart& chart, double common_unit) {
  const double unit = common_unit / chart.weight;
  Outline outline;
  std::vector<Vec2> used = used_points(chart);
  if (used.empty()) used.push_back(Vec2::Zero());
  Vec2 low = used.front();
  Vec2 high = used.front();
  for (const Vec2& point : used) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  outline.centre = 0.5 * (low + high);
  outline.away = outline.centre.norm() / unit;
  auto local = [&](int32_t index) -> Vec2 { return (chart.uv[index] - outline.centre) / unit; };

  auto twice_area = [&](const Triangle& t) {
    const Vec2 a = local(t[0]);
    return cross(local(t[1]) - a, local(t[2]) - a);
  };
  bool any_left = false;
  bool any_right = false;
  for (const Triangle& t : chart.triangles) {
    const double twice = twice_area(t);
    outline.area += 0.5 * std::abs(twice);
    any_left |= twice > 0.0;
    any_right |= twice < 0.0;
  }
  std::vector<Triangle> triangles = chart.triangles;
  for (Triangle& t : triangles) {
    // A mirrored chart is turned round as a whole; in a mixed one each triangle by itself.
    if (any_left ? twice_area(t) < 0.0 : any_right) std::swap(t[1], t[2]);
  }
  if (any_left && any_right) {
    // Where triangles lie on each other, slivers of no area have no winding to be joined by.
    const auto flat = std::stable_partition(triangles.begin(), triangles.end(),
                                            [&](const Triangle& t) { return twice_area(t) > 0.0; });
    for (auto t = flat; t != triangles.end(); ++t) {
      for (int32_t corner : *t) outline.loops.points.push_back(local(corner));
      outline.loops.close();
    }
    triangles.erase(flat, triangles.end());
  }
  walk_loops(boundary_edges(triangles), local, outline.loops);
  for (Vec2& point : used) point = (point - outline.centre) / unit;
  outline.hull = convex_hull(std::move(used));
  if (outline.loops.count() == 0) {  // no triangles, or degenerate ones that cancel out
    outline.loops.points = outline.hull;
    outline.loops.close();
  }
  outline.loops.for_each_side(
      [&](const Vec2& a, const Vec2& b) { outline.perimeter += (b - a).norm(); });
  for (const Vec2& point : outline.hull) outline.radius = std::max(outline.radius, point.norm());
  return outline;
}

}  // namespace

void Loops::close() {
  const int32_t end = static_cast<int32_t>(points.size());
  if (end > start.back()) start.push_back(end);
}

std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
    return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2> hull(2 * points.size());
  size_t size = 0;
  auto add = [&](const Vec2& point, size_t floor) {
    while (size > floor && cross(hull[size - 1] - hull[size - 2], point - hull[size - 2]) <= 0.0) {
      --size;
    }
    hull[size++] = point;
  };
  for (const Vec2& point : points) add(point, 1);
  const size_t floor = size;
  for (size_t i = points.size() - 1; i-- > 0;) add(points[i], floor);
  hull.resize(size - 1);
  return hull;
}

Outlines make_outlines(const std::vector<PackChart>& charts) {
  Outlines outlines;
  double unit = 0.0;
  for (const PackChart& chart : charts) {
    Vec2 low = Vec2::Constant(INFINITY);
    Vec2 high = Vec2::Constant(-INFINITY);
    const std::vector<Vec2> used = used_points(chart);
    for (const Vec2& point : used) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    if (!used.empty()) unit = std::max(unit, 0.5 * (high - low).norm() * chart.weight);
  }
  if (unit > 0.0) outlines.unit = unit;
  outlines.charts.reserve(charts.size());
  for (const PackChart& chart : charts) {
    outlines.charts.push_back(make_outline(chart, outlines.unit));
  }
  return outlines;
}

}  // namespace partuv::packing
