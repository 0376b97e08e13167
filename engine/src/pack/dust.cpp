#include "pack/dust.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "pack/greedy.hpp"
#include "pack/polish.hpp"

namespace partuv::packing {

namespace {

struct Split {
  std::vector<int> large, dust;
};

/// The fewest largest charts that leave little area to the others; none are large where that takes
/// too many for a search to gain anything.
Split split(const std::vector<Outline>& charts) {
  constexpr size_t most = 100;
  constexpr double little = 0.1;  // share of the area
  double rest = 0.0;
  for (const Outline& chart : charts) rest += chart.area;
  const double enough = little * rest;
  std::vector<int> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return charts[a].area > charts[b].area; });
  size_t count = 0;
  while (count < order.size() && rest > enough) rest -= charts[order[count++]].area;
  if (count > most) return {};
  Split result{{order.begin(), order.begin() + count}, {order.begin() + count, order.end()}};
  std::sort(result.large.begin(), result.large.end());
  std::sort(result.dust.begin(), result.dust.end());
  return result;
}

std::vector<Outline> chosen(const std::vector<Outline>& charts, const std::vector<int>& which) {
  std::vector<Outline> result;
  for (const int chart : which) result.push_back(charts[chart]);
  return result;
}

}  // namespace

Layout fill_around_large(const std::vector<Outline>& charts, const Bin& bin, const TilePlan& plan,
                         double least_scale, const Context& context) {
  constexpr double finest = 1.002;
  const Split parts = split(charts);
  Layout found;
  if (parts.large.empty()) return found;
  const std::vector<Outline> large = chosen(charts, parts.large);
  const std::vector<Outline> dust = chosen(charts, parts.dust);
  const Layout placed = fill_tile(large, bin, plan, context);
  const double cell = (bin.side + bin.gutter) / plan.cells;
  const Polisher polisher(large, bin, placed.scale, plan.upright);
  const std::vector<Shape> shapes =
      make_shapes(dust, 0.05 * cell / placed.scale, bin.gutter / placed.scale, plan.upright);
  found.poses.resize(charts.size());
  double low = least_scale, high = finest * placed.scale;
  double trial = placed.scale;
  while (trial > finest * low && !context.stopping()) {
    const Layout around = polisher.shrunk(placed, trial, context);
    Layout between;
    if (around.scale > 0.0) {
      const MaskSet masks(shapes, bin, trial, plan.cells, 2 * plan.rotations, Cover::touched,
                          context);
      between = greedy_around(large, around, shapes, masks, context);
    }
    if (between.scale > 0.0) {
      low = found.scale = trial;
      for (size_t i = 0; i < large.size(); ++i) found.poses[parts.large[i]] = around.poses[i];
      for (size_t i = 0; i < dust.size(); ++i) found.poses[parts.dust[i]] = between.poses[i];
    } else {
      high = trial;
    }
    trial = std::sqrt(low * high);
  }
  return found;
}

}  // namespace partuv::packing
