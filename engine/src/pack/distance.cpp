#include "pack/distance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pack/capsule.hpp"

namespace partuv::packing {

namespace {

double turn(const Segment& s, const Vec2& p) {
  const Vec2 d = s.b - s.a;
  const Vec2 e = p - s.a;
  return d.x() * e.y() - d.y() * e.x();
}

double squared_distance(const Vec2& p, const Segment& s) {
  const Vec2 along = s.b - s.a;
  const double squared = along.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((p - s.a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - s.a - share * along).squaredNorm();
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
  std::vector<int32_t> start;  // per cell, offsets into `side`
  std::vector<int32_t> side;   // ascending within a cell
};

/// Sides by the cells they touch once grown by half the reach: two sides within the reach
/// share a cell.
Cells sort_into_cells(const PlacedSides& placed, double reach) {
  Box box;
  double length = 0.0;
  for (const Segment& side : placed.sides) {
    box.add(side);
    length += (side.b - side.a).norm();
  }
  const double count = std::max<double>(1.0, double(placed.sides.size()));
  const double extent = std::max(1e-9, (box.high - box.low).maxCoeff() + reach);
  const double cell = std::max({reach, length / count, extent / 2048.0});
  const double growth = 0.5 * reach / cell;
  const Vec2 corner = box.low.array() - 0.5 * reach;
  Cells cells;
  cells.columns = static_cast<int>(extent / cell) + 2;
  const int most = cells.columns - 1;
  std::vector<std::pair<int32_t, int32_t>> entries;  // cell, side
  entries.reserve(3 * placed.sides.size());
  auto index = [&](double at) { return std::clamp(static_cast<int>(std::floor(at)), 0, most); };
  for (int32_t i = 0; i < static_cast<int32_t>(placed.sides.size()); ++i) {
    const Vec2 a = (placed.sides[i].a - corner) / cell;
    const Vec2 b = (placed.sides[i].b - corner) / cell;
    const Vec2 low = a.cwiseMin(b).array() - growth;
    const Vec2 high = a.cwiseMax(b).array() + growth;
    const bool is_short = (high - low).maxCoeff() < 3.0;  // its box has few cells too many
    const Capsule capsule(a, b, growth);
    for (int row = index(low.y()); row <= index(high.y()); ++row) {
      double left = is_short ? low.x() : INFINITY;
      double right = is_short ? high.x() : -INFINITY;
      if (!is_short) capsule.reach(row, left, right);
      if (left > right) continue;
      const int last = index(right);
      for (int column = index(left); column <= last; ++column) {
        entries.emplace_back(row * cells.columns + column, i);
      }
    }
  }
  cells.start.assign(size_t(cells.columns) * cells.columns + 1, 0);
  for (const auto& [at, side] : entries) ++cells.start[at + 1];
  for (size_t i = 1; i < cells.start.size(); ++i) cells.start[i] += cells.start[i - 1];
  cells.side.resize(entries.size());
  std::vector<int32_t> next(cells.start.begin(), cells.start.end() - 1);
  for (const auto& [at, side] : entries) cells.side[next[at]++] = side;
  return cells;
}

/// Calls body(i, j, distance) for pairs of different charts within the reach that `body` sets; the
/// same pair may come up in several cells.
template <typename Body>
void visit_pairs(const PlacedSides& placed, double first_reach, Body&& body) {
  double reach = first_reach;
  if (placed.sides.empty()) return;
  const Cells cells = sort_into_cells(placed, first_reach);
  std::vector<Box> boxes(placed.sides.size());
  for (size_t i = 0; i < boxes.size(); ++i) boxes[i].add(placed.sides[i]);
  struct Group {
    int32_t begin, end;
    Box box;
  };
  std::vector<Group> groups;
  for (size_t cell = 0; cell + 1 < cells.start.size(); ++cell) {
    groups.clear();
    for (int32_t i = cells.start[cell]; i < cells.start[cell + 1]; ++i) {
      const int32_t side = cells.side[i];
      if (groups.empty() || placed.chart[cells.side[groups.back().begin]] != placed.chart[side]) {
        groups.push_back({i, i, {}});
      }
      groups.back().end = i + 1;
      groups.back().box.add(placed.sides[side]);
    }
    for (size_t one = 0; one < groups.size(); ++one) {
      for (size_t two = one + 1; two < groups.size(); ++two) {
        if (groups[one].box.apart(groups[two].box, reach)) continue;
        for (int32_t i = groups[one].begin; i < groups[one].end; ++i) {
          const Segment& first = placed.sides[cells.side[i]];
          const Box& box = boxes[cells.side[i]];
          if (box.apart(groups[two].box, reach)) continue;
          for (int32_t j = groups[two].begin; j < groups[two].end; ++j) {
            if (box.apart(boxes[cells.side[j]], reach)) continue;
            const double distance = segment_distance(first, placed.sides[cells.side[j]]);
            if (distance <= reach) reach = body(cells.side[i], cells.side[j], distance);
          }
        }
      }
    }
  }
}

}  // namespace

double point_distance(const Vec2& p, const Segment& s) { return std::sqrt(squared_distance(p, s)); }

bool cross(const Segment& one, const Segment& two) {
  return turn(one, two.a) * turn(one, two.b) < 0.0 && turn(two, one.a) * turn(two, one.b) < 0.0;
}

double segment_distance(const Segment& one, const Segment& two) {
  if (cross(one, two)) return 0.0;
  return std::sqrt(std::min(std::min(squared_distance(one.a, two), squared_distance(one.b, two)),
                            std::min(squared_distance(two.a, one), squared_distance(two.b, one))));
}

PlacedSides place_sides(const std::vector<Loops>& loops, const Layout& layout) {
  PlacedSides placed;
  size_t count = 0;
  for (const Loops& chart : loops) count += chart.points.size();
  placed.sides.reserve(count);
  placed.chart.reserve(count);
  placed.previous.reserve(count);
  placed.next.reserve(count);
  for (size_t i = 0; i < loops.size(); ++i) {
    const Turn turn(layout.poses[i].rotation_rad, layout.scale);
    const Vec2& centre = layout.poses[i].centre;
    const int32_t base = static_cast<int32_t>(placed.sides.size());
    for (int loop = 0; loop < loops[i].count(); ++loop) {
      const int32_t first = loops[i].start[loop];
      const int32_t last = loops[i].start[loop + 1] - 1;
      for (int32_t p = first; p <= last; ++p) {
        const int32_t after = loops[i].next(loop, p);
        placed.sides.push_back(
            {turn(loops[i].points[p]) + centre, turn(loops[i].points[after]) + centre});
        placed.chart.push_back(static_cast<int32_t>(i));
        placed.previous.push_back(base + (p > first ? p - 1 : last));
        placed.next.push_back(base + after);
      }
    }
  }
  return placed;
}

std::vector<NearPair> near_pairs(const PlacedSides& placed, double reach) {
  std::vector<NearPair> pairs;
  visit_pairs(placed, reach, [&](int32_t one, int32_t two, double distance) {
    pairs.push_back({one, two, distance});
    return reach;
  });
  auto key = [](const NearPair& pair) { return int64_t(pair.one) << 32 | pair.two; };
  std::sort(pairs.begin(), pairs.end(),
            [&](const NearPair& a, const NearPair& b) { return key(a) < key(b); });
  pairs.erase(std::unique(pairs.begin(), pairs.end(),
                          [&](const NearPair& a, const NearPair& b) { return key(a) == key(b); }),
              pairs.end());
  return pairs;
}

double least_distance(const PlacedSides& placed, double reach) {
  double least = reach;
  visit_pairs(placed, reach, [&](int32_t, int32_t, double distance) {
    least = std::min(least, distance);
    return least;
  });
  return least;
}

}  // namespace partuv::packing
