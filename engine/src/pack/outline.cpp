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

struct Box {
  Vec2 low = Vec2::Constant(INFINITY), high = Vec2::Constant(-INFINITY);

  bool empty() const { return !(low.x() <= high.x()); }
};

/// Visits the corners of the triangles; of a chart without any, all points.
template <typename Visit>
void for_each_corner(const PackChart& chart, Visit&& visit) {
  for (const Triangle& triangle : chart.triangles) {
    for (int32_t corner : triangle) visit(chart.uv[corner]);
  }
  if (chart.triangles.empty()) std::for_each(chart.uv.begin(), chart.uv.end(), visit);
}

Box box_around(const PackChart& chart) {
  Box box;
  for_each_corner(chart, [&](const Vec2& point) {
    box.low = box.low.cwiseMin(point);
    box.high = box.high.cwiseMax(point);
  });
  return box;
}

Outline make_outline(const PackChart& chart, const Box& box, double common_unit) {
  const double unit = common_unit / chart.weight;
  Outline outline;
  if (!box.empty()) outline.centre = 0.5 * (box.low + box.high);
  outline.away = outline.centre.norm() / unit;
  auto local = [&](const Vec2& point) -> Vec2 { return (point - outline.centre) / unit; };

  auto twice_area = [&](const Triangle& t) {
    const Vec2 a = local(chart.uv[t[0]]);
    return cross(local(chart.uv[t[1]]) - a, local(chart.uv[t[2]]) - a);
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
      for (int32_t corner : *t) outline.loops.points.push_back(local(chart.uv[corner]));
      outline.loops.close();
    }
    triangles.erase(flat, triangles.end());
  }
  const auto place = [&](int32_t index) { return local(chart.uv[index]); };
  walk_loops(boundary_edges(triangles), place, outline.loops);
  if (outline.loops.count() > 0) {
    outline.hull = convex_hull(outline.loops.points);
  } else {  // no triangles, or degenerate ones that cancel out
    std::vector<Vec2> points;
    for_each_corner(chart, [&](const Vec2& point) { points.push_back(local(point)); });
    if (points.empty()) points.push_back(Vec2::Zero());
    outline.hull = convex_hull(std::move(points));
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

Outlines make_outlines(const std::vector<PackChart>& charts, const Context& context) {
  Outlines outlines;
  std::vector<Box> boxes;
  double unit = 0.0;
  for (const PackChart& chart : charts) {
    boxes.push_back(box_around(chart));
    const Box& box = boxes.back();
    if (!box.empty()) unit = std::max(unit, 0.5 * (box.high - box.low).norm() * chart.weight);
  }
  if (unit > 0.0) outlines.unit = unit;
  outlines.charts.resize(charts.size());
  parallel_for(context, static_cast<int>(charts.size()), [&](int c) {
    outlines.charts[c] = make_outline(charts[c], boxes[c], outlines.unit);
  });
  return outlines;
}

}  // namespace partuv::packing
