#include "find_charts.hpp"

#include <algorithm>

#include "assemble.hpp"
#include "segment/graft.hpp"
#include "stages.hpp"

namespace partuv {
namespace {

constexpr double progress_from = 0.12, progress_to = 0.9;
constexpr int searches_if_exact = 2;

/// The surface, its stand-in, and what both are good for.
struct Ground {
  const Surface& surface;
  const StandIn& stand_in;
  std::vector<double> weight;  ///< per proxy face: how many faces it stands for
};

/// Fewer charts, or as many with better angles.
bool better(const std::vector<SolvedChart>& some, const std::vector<SolvedChart>& others) {
  if (some.size() != others.size()) return some.size() < others.size();
  return mean_angular(some) > mean_angular(others);
}

/// span: of the progress that the search and the solving of its charts take.
std::vector<SolvedChart> find_along(const Ground& ground, const PartTree& tree,
                                    SearchOptions search, const Span& span, Stages& stages,
                                    Context& context, int32_t& searched_charts) {
  // The angular bound holds for the atlas; a single chart may lie further from conformal, and
  // seldom do all of them. Where they do, charts that pull the mean down are halved, and a stricter
  // search is tried as well: which of the two ends with fewer charts hangs on little.
  constexpr double mean_per_share = 0.035;  // what a stricter bound gains, or somewhat less
  constexpr double least_step = 0.1, longest_step = 0.35;
  std::vector<SolvedChart> fewest;
  double share = loosest_share;
  for (int searches = 1;; ++searches) {
    stages.enter("search", span.from, span.at(0.55));
    search.flatten.min_angular = chart_angular(search, share);
    const ChartSet found =
        search_charts(ground.stand_in.proxy.surface, tree, ground.weight, search, context);
    if (context.cancelled()) return {};

    stages.enter("flattening", span.at(0.55), span.to);
    // Charts that are judged on the very surface stay as they are, cuts and all.
    const ChartSet regions = ground.stand_in.exact
                                 ? found
                                 : lift_charts(ground.surface, ground.stand_in.side_weights,
                                               ground.stand_in.proxy, found, context);
    std::vector<SolvedChart> solved = solve_charts(ground.surface, regions, search, context);
    if (context.cancelled()) return {};
    const double reserve = search.final_merge ? hanging_angular_cost : 0.0;
    const double missing = raise_mean_angular(ground.surface, search, context, solved, reserve);
    if (search.final_merge) hang_small_charts(ground.surface, search, context, solved);
    if (context.cancelled()) return {};
    if (fewest.empty() || better(solved, fewest)) {
      fewest = std::move(solved);
      searched_charts = static_cast<int32_t>(found.size());
    }
    if (missing <= 0.0 || searches == search.most_searches || context.stopping()) return fewest;
    share -= std::clamp(missing / mean_per_share, least_step, longest_step);
  }
}

/// Of each component the charts of the attempt that has the fewest there; the first of equals.
std::vector<SolvedChart> fewest_per_component(const Surface& surface,
                                              std::vector<std::vector<SolvedChart>> attempts) {
  std::vector<int32_t> component;
  const int components = label_components(surface, component);
  const auto home = [&](const SolvedChart& chart) {
    return component[chart.flattening.piece.source_face.front()];
  };
  std::vector<int32_t> fewest(components, -1), taken(components, 0);
  for (size_t i = 0; i < attempts.size(); ++i) {
    std::vector<int32_t> count(components, 0);
    for (const SolvedChart& chart : attempts[i]) ++count[home(chart)];
    for (int c = 0; c < components; ++c) {
      if (fewest[c] >= 0 && count[c] >= fewest[c]) continue;
      fewest[c] = count[c];
      taken[c] = static_cast<int32_t>(i);
    }
  }
  std::vector<SolvedChart> charts;
  int32_t first_part = 0;
  for (size_t i = 0; i < attempts.size(); ++i) {
    int32_t parts = 0;
    for (SolvedChart& chart : attempts[i]) {
      parts = std::max(parts, chart.part + 1);
      if (taken[home(chart)] != static_cast<int32_t>(i)) continue;
      chart.part += first_part;  // parts of different searches are different parts
      charts.push_back(std::move(chart));
    }
    first_part += parts;
  }
  return charts;
}

}  // namespace

std::vector<SolvedChart> find_charts(const Surface& surface, const StandIn& stand_in,
                                     const std::vector<PartTree>& trees,
                                     const std::vector<SearchOptions>& searches, Stages& stages,
                                     Context& context, int32_t& searched_charts) {
  const Proxy& proxy = stand_in.proxy;
  Ground ground{surface, stand_in, std::vector<double>(proxy.surface.faces.size(), 0.0)};
  for (const int p : proxy.proxy_of_face) ground.weight[p] += 1.0;
  const double step = (progress_to - progress_from) /
                      static_cast<double>(std::max<size_t>(trees.size() * searches.size(), 1));
  std::vector<std::vector<SolvedChart>> attempts;
  for (const PartTree& tree : trees) {
    for (SearchOptions search : searches) {
      if (!attempts.empty() && context.stopping()) break;
      search.partial_weld = stand_in.exact;
      // One chart less on a coarser surface is no more than a guess, and what Merge finds, sorted
      // by the axes of a box, merges less well with the parts around it.
      search.least_merge_gain = proxy.surface.face_count() < surface.face_count() ? 2 : 1;
      // What is searched on the very surface is small: to search it again costs little.
      if (stand_in.exact) search.most_searches = std::max(search.most_searches, searches_if_exact);
      const double from = progress_from + step * static_cast<double>(attempts.size());
      int32_t searched = 0;
      attempts.push_back(
          find_along(ground, tree, search, {from, from + step}, stages, context, searched));
      if (context.cancelled()) return {};
      if (attempts.size() == 1) searched_charts = searched;
    }
  }
  if (attempts.size() == 1) return std::move(attempts.front());
  std::vector<SolvedChart> charts = fewest_per_component(surface, std::move(attempts));
  // Each search met the bound as a whole; what was taken of them may not.
  raise_mean_angular(surface, searches.front(), context, charts);
  return charts;
}

}  // namespace partuv
