#include "pack/assign.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace partuv::packing {

namespace {

/// Charts that stay in one tile.
struct Unit {
  std::vector<int> charts;
  double area = 0.0;
};

std::vector<Unit> by_part(const std::vector<PackChart>& charts, const std::vector<double>& area) {
  std::vector<int> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::tuple(charts[a].rank, charts[a].part) < std::tuple(charts[b].rank, charts[b].part);
  });
  std::vector<Unit> units;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || charts[order[i]].part != charts[order[i - 1]].part) units.emplace_back();
    units.back().charts.push_back(order[i]);
    units.back().area += area[order[i]];
  }
  return units;
}

/// Cut units above a size into their charts.
std::vector<Unit> split(const std::vector<Unit>& units, const std::vector<double>& area,
                        double size) {
  std::vector<Unit> pieces;
  for (const Unit& unit : units) {
    if (unit.area <= size) {
      pieces.push_back(unit);
      continue;
    }
    for (int chart : unit.charts) pieces.push_back({{chart}, area[chart]});
  }
  return pieces;
}

/// Tiles that runs of units of at most this area take; the last one holds what is left. Every tile
/// gets a unit while there are any.
std::vector<int32_t> cut(const std::vector<Unit>& units, int tiles, double most) {
  std::vector<int32_t> tile(units.size());
  int32_t current = 0;
  double filled = 0.0;
  for (size_t i = 0; i < units.size(); ++i) {
    const bool full = i > 0 && filled + units[i].area > most;
    const bool spare = i > 0 && units.size() - i <= static_cast<size_t>(tiles - 1 - current);
    if ((full || spare) && current + 1 < tiles) {
      ++current;
      filled = 0.0;
    }
    tile[i] = current;
    filled += units[i].area;
  }
  return tile;
}

double fullest(const std::vector<Unit>& units, const std::vector<int32_t>& tile, int tiles) {
  std::vector<double> filled(tiles, 0.0);
  for (size_t i = 0; i < units.size(); ++i) filled[tile[i]] += units[i].area;
  return *std::max_element(filled.begin(), filled.end());
}

}  // namespace

std::vector<int32_t> assign_tiles(const std::vector<PackChart>& charts,
                                  const std::vector<double>& area, int tiles) {
  std::vector<int32_t> result(charts.size(), 0);
  std::vector<Unit> units = by_part(charts, area);
  if (tiles == 0) {
    for (size_t i = 0; i < units.size(); ++i) {
      for (int chart : units[i].charts) result[chart] = static_cast<int32_t>(i);
    }
    return result;
  }
  const double total = std::accumulate(area.begin(), area.end(), 0.0);
  constexpr double fair = 1.1;  // a part above this multiple of a tile's share is spread
  const bool few = units.size() < static_cast<size_t>(tiles);
  units = split(units, area, few ? 0.0 : fair * total / tiles);
  // The least area that the fullest tile can do with.
  double low = total / tiles;
  double high = total;
  constexpr int halvings = 40;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (fullest(units, cut(units, tiles, middle), tiles) <= middle ? high : low) = middle;
  }
  const std::vector<int32_t> tile = cut(units, tiles, high);
  for (size_t i = 0; i < units.size(); ++i) {
    for (int chart : units[i].charts) result[chart] = tile[i];
  }
  return result;
}

}  // namespace partuv::packing
