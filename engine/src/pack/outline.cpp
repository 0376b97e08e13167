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
    for (; balance > 0; --balance) boundary.push_back({low, high});
    for (; balance < 0; ++balance) boundary.push_back({high, low});
  }
  return boundary;
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

Outline make_outline(const PackChart& chart, double unit) {
  Outline outline;
  std::vector<Vec2> used = used_points(chart);
  if (used.empty()) return outline;
  Vec2 low = used.front();
  Vec2 high = used.front();
  for (const Vec2& point : used) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  outline.centre = 0.5 * (low + high);
  auto local = [&](int32_t index) -> Vec2 { return (chart.uv[index] - outline.centre) / unit; };

  bool turned = false;
  for (const Triangle& t : chart.triangles) {
    const double twice = cross(chart.uv[t[1]] - chart.uv[t[0]], chart.uv[t[2]] - chart.uv[t[0]]);
    turned |= twice < 0.0;
    outline.area += 0.5 * std::abs(twice) / (unit * unit);
  }
  if (turned) {
    for (const Triangle& t : chart.triangles) {
      const double twice = cross(chart.uv[t[1]] - chart.uv[t[0]], chart.uv[t[2]] - chart.uv[t[0]]);
      std::array<Vec2, 3> corner{local(t[0]), local(t[1]), local(t[2])};
      if (twice < 0.0) std::swap(corner[1], corner[2]);
      for (int side = 0; side < 3; ++side) {
        outline.segments.push_back({corner[side], corner[(side + 1) % 3]});
      }
    }
  } else {
    for (const auto& [start, stop] : boundary_edges(chart.triangles)) {
      outline.segments.push_back({local(start), local(stop)});
    }
  }
  for (Vec2& point : used) point = (point - outline.centre) / unit;
  outline.hull = convex_hull(std::move(used));
  if (outline.segments.empty()) {  // no triangles, or degenerate ones that cancel out
    for (size_t i = 0; i < outline.hull.size(); ++i) {
      outline.segments.push_back({outline.hull[i], outline.hull[(i + 1) % outline.hull.size()]});
    }
  }
  for (const Segment& segment : outline.segments) {
    outline.perimeter += (segment.b - segment.a).norm();
  }
  for (const Vec2& point : outline.hull) outline.radius = std::max(outline.radius, point.norm());
  return outline;
}

}  // namespace

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
    if (!used.empty()) unit = std::max(unit, 0.5 * (high - low).norm());
  }
  if (unit > 0.0) outlines.unit = unit;
  outlines.charts.reserve(charts.size());
  for (const PackChart& chart : charts)
    outlines.charts.push_back(make_outline(chart, outlines.unit));
  return outlines;
}

}  // namespace partuv::packing
