#include "pack/distance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pack/capsule.hpp"

namespace partuv::packing {

namespace {

double point_distance(const Vec2& p, const Segment& s) {
  const Vec2 along = s.b - s.a;
  const double squared = along.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((p - s.a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - s.a - share * along).norm();
}

double turn(const Segment& s, const Vec2& p) {
  const Vec2 d = s.b - s.a;
  const Vec2 e = p - s.a;
  return d.x() * e.y() - d.y() * e.x();
}

struct Box {
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);
  void add(const Segment& s) {
    low = low.cwiseMin(s.a).cwiseMin(s.b);
    high = high.cwiseMax(s.a).cwiseMax(s.b);
  }
  bool apart(const Box& other, double reach) const {
    return (low - other.high).maxCoeff() > reach || (other.low - high).maxCoeff() > reach;
  }
};

struct Cells {
  int columns = 0;
  std::vector<int32_t> start;    // per cell, offsets into `segment`
  std::vector<int32_t> segment;  // ascending within a cell
};

/// Segments by the cells they touch once grown by half the reach: two segments within the reach
/// share a cell.
Cells sort_into_cells(const PlacedSegments& placed, double reach) {
  Box box;
  double length = 0.0;
  for (const Segment& segment : placed.segments) {
    box.add(segment);
    length += (segment.b - segment.a).norm();
  }
  const double count = std::max<double>(1.0, double(placed.segments.size()));
  const double extent = std::max(1e-9, (box.high - box.low).maxCoeff() + reach);
  const double cell = std::max({reach, length / count, extent / 2048.0});
  const double growth = 0.5 * reach / cell;
  const Vec2 corner = box.low.array() - 0.5 * reach;
  Cells cells;
  cells.columns = static_cast<int>(extent / cell) + 2;
  const int rows = cells.columns;
  auto visit = [&](auto&& body) {
    for (int32_t i = 0; i < static_cast<int32_t>(placed.segments.size()); ++i) {
      const Vec2 a = (placed.segments[i].a - corner) / cell;
      const Vec2 b = (placed.segments[i].b - corner) / cell;
      const Capsule capsule(a, b, growth);
      const int first = std::max(0, int(std::floor(std::min(a.y(), b.y()) - growth)));
      const int last = std::min(rows - 1, int(std::floor(std::max(a.y(), b.y()) + growth)));
      for (int row = first; row <= last; ++row) {
        double left = INFINITY;
        double right = -INFINITY;
        capsule.reach(row, left, right);
        if (left > right) continue;
        const int begin = std::max(0, int(std::floor(left)));
        const int end = std::min(cells.columns - 1, int(std::floor(right)));
        for (int column = begin; column <= end; ++column) body(row * cells.columns + column, i);
      }
    }
  };
  cells.start.assign(size_t(rows) * cells.columns + 1, 0);
  visit([&](int at, int32_t) { ++cells.start[at + 1]; });
  for (size_t i = 1; i < cells.start.size(); ++i) cells.start[i] += cells.start[i - 1];
  cells.segment.resize(cells.start.back());
  std::vector<int32_t> next(cells.start.begin(), cells.start.end() - 1);
  visit([&](int at, int32_t i) { cells.segment[next[at]++] = i; });
  return cells;
}

/// Calls body(i, j, distance) for pairs of different charts within the reach that `body` sets; the
/// same pair may come up in several cells.
template <typename Body>
void visit_pairs(const PlacedSegments& placed, double first_reach, Body&& body) {
  double reach = first_reach;
  if (placed.segments.empty()) return;
  const Cells cells = sort_into_cells(placed, first_reach);
  struct Group {
    int32_t begin, end;
    Box box;
  };
  std::vector<Group> groups;
  for (size_t cell = 0; cell + 1 < cells.start.size(); ++cell) {
    groups.clear();
    for (int32_t i = cells.start[cell]; i < cells.start[cell + 1]; ++i) {
      const int32_t segment = cells.segment[i];
      if (groups.empty() ||
          placed.chart[cells.segment[groups.back().begin]] != placed.chart[segment]) {
        groups.push_back({i, i, {}});
      }
      groups.back().end = i + 1;
      groups.back().box.add(placed.segments[segment]);
    }
    for (size_t one = 0; one < groups.size(); ++one) {
      for (size_t two = one + 1; two < groups.size(); ++two) {
        if (groups[one].box.apart(groups[two].box, reach)) continue;
        for (int32_t i = groups[one].begin; i < groups[one].end; ++i) {
          const Segment& first = placed.segments[cells.segment[i]];
          Box box;
          box.add(first);
          if (box.apart(groups[two].box, reach)) continue;
          for (int32_t j = groups[two].begin; j < groups[two].end; ++j) {
            const Segment& second = placed.segments[cells.segment[j]];
            Box other;
            other.add(second);
            if (box.apart(other, reach)) continue;
            const double distance = segment_distance(first, second);
            if (distance <= reach) reach = body(cells.segment[i], cells.segment[j], distance);
          }
        }
      }
    }
  }
}

}  // namespace

double segment_distance(const Segment& one, const Segment& two) {
  if (turn(one, two.a) * turn(one, two.b) < 0.0 && turn(two, one.a) * turn(two, one.b) < 0.0) {
    return 0.0;
  }
  return std::min(std::min(point_distance(one.a, two), point_distance(one.b, two)),
                  std::min(point_distance(two.a, one), point_distance(two.b, one)));
}

PlacedSegments place_segments(const std::vector<Outline>& charts, const Layout& layout,
                              double growth) {
  PlacedSegments placed;
  size_t count = 0;
  for (const Outline& outline : charts) count += outline.segments.size();
  placed.segments.reserve(count);
  placed.chart.reserve(count);
  for (size_t i = 0; i < charts.size(); ++i) {
    const Turn turn(layout.poses[i].rotation_rad, layout.scale * growth);
    for (const Segment& segment : charts[i].segments) {
      placed.segments.push_back(
          {turn(segment.a) + layout.poses[i].centre, turn(segment.b) + layout.poses[i].centre});
      placed.chart.push_back(static_cast<int32_t>(i));
    }
  }
  return placed;
}

std::vector<NearPair> near_pairs(const PlacedSegments& placed, double reach) {
  std::vector<NearPair> pairs;
  visit_pairs(placed, reach, [&](int32_t one, int32_t two, double distance) {
    pairs.push_back({one, two, distance});
    return reach;
  });
  auto key = [](const NearPair& pair) { return std::pair(pair.one, pair.two); };
  std::sort(pairs.begin(), pairs.end(),
            [&](const NearPair& a, const NearPair& b) { return key(a) < key(b); });
  pairs.erase(std::unique(pairs.begin(), pairs.end(),
                          [&](const NearPair& a, const NearPair& b) { return key(a) == key(b); }),
              pairs.end());
  return pairs;
}

double least_distance(const PlacedSegments& placed, double reach) {
  double least = reach;
  visit_pairs(placed, reach, [&](int32_t, int32_t, double distance) {
    least = std::min(least, distance);
    return least;
  });
  return least;
}

}  // namespace partuv::packing
