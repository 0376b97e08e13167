#include "pack/group.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "pack/cluster.hpp"
#include "pack/polish.hpp"
#include "pack/swap.hpp"

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

/// Charts with those of a part together at a scale of `target` or more, if that is found.
class Gathering {
 public:
  Gathering(const std::vector<Outline>& charts, const std::vector<std::vector<int>>& groups,
            const Bin& bin, const TilePlan& plan, double target, const Context& context)
      : charts_(charts),
        groups_(groups),
        bin_(bin),
        quick_(plan),
        thorough_(plan),
        target_(target),
        context_(context) {
    quick_.effort = 0.0;
    thorough_.effort = 0.4 * plan.effort;
  }

  /// The fewest groups are taken apart, the largest first, that a quick look finds promising; then
  /// more, while there is time.
  Layout run() {
    constexpr int most_attempts = 6;
    const size_t several = std::count_if(groups_.begin(), groups_.end(),
                                         [](const auto& group) { return group.size() > 1; });
    const bool look = charts_.size() <= searched_charts && thorough_.effort > 0.0;
    const double loose = look ? fill_tile(charts_, bin_, quick_, context_).scale : 0.0;
    int attempts = 0;
    size_t next = 0;
    for (size_t open = 0; open < several && attempts < most_attempts && !context_.stopping();
         open = next) {
      next = look ? 2 * open + 1 : open + 1 + several / 4;
      const std::vector<Cluster> clusters = make(released(charts_, groups_, open));
      if (clusters.empty()) continue;
      if (look && fill(clusters, quick_).scale < promising * loose) continue;
      ++attempts;
      Layout layout =
          explode(clusters, charts_.size(), made_at * target_, fill(clusters, thorough_));
      tighten(layout);
      if (layout.scale >= target_) return layout;
      next = open + 1 + several / 8;
    }
    return {};
  }

 private:
  static constexpr double made_at = 0.985;   // of the target: charts gain once they move freely
  static constexpr double promising = 0.93;  // of the scale at a quick look

  const std::vector<Outline>& charts_;
  const std::vector<std::vector<int>>& groups_;
  const Bin& bin_;
  TilePlan quick_, thorough_;
  double target_;
  const Context& context_;

  std::vector<Cluster> make(const std::vector<std::vector<int>>& groups) const {
    std::vector<Cluster> clusters(groups.size());
    parallel_for(context_, static_cast<int>(groups.size()), [&](int i) {
      clusters[i] = make_cluster(charts_, groups[i], bin_, quick_.cells, made_at * target_,
                                 Hull::outlines, context_);
    });
    for (const Cluster& cluster : clusters) {
      if (cluster.poses.empty()) return {};
    }
    return clusters;
  }

  Layout fill(const std::vector<Cluster>& clusters, const TilePlan& plan) const {
    std::vector<Outline> outlines;
    for (const Cluster& cluster : clusters) outlines.push_back(cluster.outline);
    return fill_tile(outlines, bin_, plan, context_);
  }

  void tighten(Layout& layout) const {
    constexpr int steps = 40;
    const Polisher polisher(charts_, bin_, layout.scale, false);
    Layout tight = layout;
    polisher.tighten(tight, steps, Caught::fail, context_);
    if (tight.scale > layout.scale || layout.scale < made_at * target_) layout = std::move(tight);
    polisher.settle(layout, context_);
    if (layout.scale > 0.0) polisher.close_up(layout, context_);
  }
};

}  // namespace

Layout fill_grouped(const std::vector<Outline>& charts, const std::vector<int32_t>& part,
                    const Bin& bin, const TilePlan& plan, Grouping grouping,
                    const Context& context) {
  constexpr double least_share = 0.951;  // finishing gains one layout less than another
  const std::vector<std::vector<int>> groups = by_part(part);
  const bool strict = grouping == Grouping::strict && groups.size() > 1;
  TilePlan first = plan;
  if (strict) first.effort = 0.0;
  Layout loose = fill_tile(charts, bin, first, context);
  const bool apart = groups.size() == charts.size() || groups.size() == 1;
  if (strict) {
    Layout layout =
        fill_groups(charts, groups, bin, plan, Hull::rectangle, 0.8 * loose.scale, context);
    return layout.scale > 0.0 ? layout : loose;
  }
  if (grouping == Grouping::none || apart) return loose;
  const double target = std::sqrt(least_share) * loose.scale;
  Layout near = Gathering(charts, groups, bin, plan, target, context).run();
  if (near.scale <= 0.0) near = std::move(loose);
  if (charts.size() <= searched_charts && plan.effort > 0.0) {
    swap_together(charts, groups, bin, target, plan.effort, near, context);
  }
  return near;
}

}  // namespace partuv::packing
