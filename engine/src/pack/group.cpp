#include "pack/group.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "pack/cluster.hpp"
#include "pack/polish.hpp"

namespace partuv::packing {

namespace {

std::vector<std::vector<int>> by_part(const std::vector<int32_t>& part) {
  std::map<int32_t, std::vector<int>> found;
  for (size_t i = 0; i < part.size(); ++i) found[part[i]].push_back(static_cast<int>(i));
  std::vector<std::vector<int>> groups;
  for (auto& [number, members] : found) groups.push_back(std::move(members));
  return groups;
}

/// Gutters are texels whatever the scale, so groups have to be laid out at the scale that comes
/// out: closes in on it from passes without search, then searches once if that may come up to
/// `guess`.
Layout fill_groups(const std::vector<Outline>& charts, const std::vector<std::vector<int>>& groups,
                   const Bin& bin, const TilePlan& plan, Hull hull, double guess,
                   const Context& context) {
  constexpr int most_passes = 8;
  constexpr double close = 1.004;
  constexpr double back = 0.99;
  constexpr double worth_search = 0.88;  // what a search gains is rarely more than the rest
  std::vector<Cluster> clusters(groups.size());
  std::vector<Outline> outlines(groups.size());
  auto pass = [&](double scale, double effort) {
    parallel_for(context, static_cast<int>(groups.size()), [&](int i) {
      clusters[i] = make_cluster(charts, groups[i], bin, plan.cells, scale, hull, context);
    });
    for (size_t i = 0; i < groups.size(); ++i) {
      if (clusters[i].poses.empty()) return Layout{};
      outlines[i] = clusters[i].outline;
    }
    TilePlan own = plan;
    own.upright = hull == Hull::rectangle;
    own.effort = effort;
    return fill_tile(outlines, bin, own, context);
  };
  Layout best;
  double made_at = 0.0;
  double scale = guess;
  for (int i = 0; i < most_passes && !context.stopping(); ++i) {
    const Layout placed = pass(scale, 0.0);
    if (placed.scale >= scale) {
      if (placed.scale > best.scale) {
        best = explode(clusters, charts.size(), scale, placed);
        made_at = scale;
      }
      if (placed.scale <= close * scale) break;
    }
    scale = placed.scale > 0.0 ? (placed.scale >= scale ? 1.0 : back) * placed.scale : 0.8 * scale;
  }
  const bool hopeless = best.scale < worth_search * guess;
  if (plan.effort <= 0.0 || hopeless || context.stopping()) return best;
  for (scale = best.scale; scale >= back * made_at && !context.stopping(); scale *= back) {
    const Layout placed = pass(scale, plan.effort);
    if (placed.scale < scale) continue;
    if (placed.scale > best.scale) best = explode(clusters, charts.size(), scale, placed);
    break;
  }
  return best;
}

/// Groups of which the largest are taken apart, `apart` of those with several charts.
std::vector<std::vector<int>> released(const std::vector<Outline>& charts,
                                       const std::vector<std::vector<int>>& groups, size_t apart) {
  std::vector<double> area(groups.size(), 0.0);
  std::vector<int> order;
  for (size_t g = 0; g < groups.size(); ++g) {
    for (int chart : groups[g]) area[g] += charts[chart].area;
    if (groups[g].size() > 1) order.push_back(static_cast<int>(g));
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return area[a] > area[b]; });
  order.resize(std::min(order.size(), apart));
  std::vector<std::vector<int>> result;
  for (size_t g = 0; g < groups.size(); ++g) {
    if (std::find(order.begin(), order.end(), static_cast<int>(g)) == order.end()) {
      result.push_back(groups[g]);
    } else {
      for (int chart : groups[g]) result.push_back({chart});
    }
  }
  return result;
}

}  // namespace

Layout fill_grouped(const std::vector<Outline>& charts, const std::vector<int32_t>& part,
                    const Bin& bin, const TilePlan& plan, Grouping grouping,
                    const Context& context) {
  constexpr double least_share = 0.95;
  constexpr int steps = 40;
  const std::vector<std::vector<int>> groups = by_part(part);
  const bool strict = grouping == Grouping::strict && groups.size() > 1;
  TilePlan first = plan;
  if (strict) first.effort = 0.0;
  const Layout loose = fill_tile(charts, bin, first, context);
  const bool apart = groups.size() == charts.size() || groups.size() == 1;
  if (strict) {
    Layout layout =
        fill_groups(charts, groups, bin, plan, Hull::rectangle, 0.8 * loose.scale, context);
    return layout.scale > 0.0 ? layout : loose;
  }
  if (grouping == Grouping::none || apart) return loose;
  const size_t several = std::count_if(groups.begin(), groups.end(),
                                       [](const auto& group) { return group.size() > 1; });
  for (size_t open = 0; open < several && !context.stopping(); open = 2 * open + 1) {
    Layout layout = fill_groups(charts, released(charts, groups, open), bin, plan, Hull::outlines,
                                0.95 * loose.scale, context);
    if (layout.scale <= 0.0) continue;
    const Polisher polisher(charts, bin, layout.scale, false);
    Layout tight = layout;
    polisher.tighten(tight, steps, context);
    polisher.settle(tight, context);
    if (tight.scale > layout.scale) layout = std::move(tight);
    if (layout.scale * layout.scale >= least_share * loose.scale * loose.scale) return layout;
  }
  return loose;
}

}  // namespace partuv::packing
