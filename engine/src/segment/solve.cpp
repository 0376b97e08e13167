#include "partuv/solve.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <unordered_map>

#include "segment/evaluator.hpp"
#include "segment/graft.hpp"
#include "segment/separate.hpp"
#include "segment/solve_region.hpp"

namespace partuv {
namespace {

/// A region, opened along the given cuts or as it takes, ready to be flattened.
std::optional<OpenedPiece> open_region(const Surface& surface, const std::vector<int32_t>& faces,
                                       const std::vector<int32_t>& cut_sides,
                                       const SearchOptions& options, const Context& context) {
  if (cut_sides.empty()) {
    return open_for_flattening(extract_piece(surface, faces, {}), prediction_limit(options.flatten),
                               options, context);
  }
  CutSides cuts(3 * surface.faces.size(), 0);
  for (int h : cut_sides) cuts[h] = 1;
  Piece piece = extract_piece(surface, faces, {}, cuts);
  ConformalScale scale = predict_scale(piece, context);
  return OpenedPiece{std::move(piece), std::move(scale)};
}

/// Flatten an opened region: whole, or in parts where it would lie on itself. Empty where neither
/// works.
Flattened flatten_region(const OpenedPiece& opened, const FlattenOptions& options,
                         const Context& context) {
  // Of 95 regions that were predicted further beyond the limit, none was flattened either way.
  constexpr double most_excess = 2.0;
  const double predicted = opened.scale.area_distortion;
  if (predicted > 1.0 + most_excess * (prediction_limit(options) - 1.0)) return {};
  // The quick way is the one of the search; either may end where the other does not.
  for (const bool quick : {options.quick, !options.quick}) {
    if (quick && !options.polish) continue;
    // As the second way, the full one costs much: of 166 regions beyond the bound it served two.
    const bool second = options.polish && options.quick && !quick;
    if (second && predicted > options.max_area_distortion) continue;
    FlattenOptions way = options;
    way.quick = quick;
    way.to_cut_apart = options.quick;
    Flattening flat = flatten(opened, way, context);
    if (!flat.within &&
        (flat.uv.empty() || flat.valid || !keeps_bounds(flat.distortion, options))) {
      if (quick && !flat.uv.empty() && stretches_hopelessly(flat.distortion, options)) break;
      continue;
    }
    Flattened found = cut_apart(std::move(flat), options, context);
    if (!found.parts.empty()) return found;
  }
  return {};
}

/// Solve regions side by side, the largest first, so that no thread is left with one at the end.
std::vector<std::vector<Flattening>> solve_regions(const Surface& surface, const ChartSet& regions,
                                                   const SearchOptions& options, Context& context,
                                                   bool report) {
  std::vector<int32_t> order(regions.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return regions[a].faces.size() > regions[b].faces.size(); });
  std::vector<std::vector<Flattening>> solved(regions.size());
  std::atomic<int64_t> done{0};
  parallel_for(context, static_cast<int>(regions.size()), [&](int i) {
    const Chart& region = regions[order[i]];
    solve_region(surface, region.faces, region.cuts, options, context, solved[order[i]]);
    const int64_t faces = done += static_cast<int64_t>(region.faces.size());
    if (report) context.advance(static_cast<double>(faces) / surface.face_count());
  });
  return solved;
}

/// Solve a region that is the outcome of so many splits; what is left over is solved side by side.
void solve_split(const Surface& surface, const std::vector<int32_t>& faces,
                 const std::vector<int32_t>& cut_sides, int splits, const SearchOptions& options,
                 const Context& context, std::vector<Flattening>& solved) {
  constexpr int most_splits = 24;
  if (context.cancelled()) return;
  const bool last_resort = faces.size() == 1 || splits >= most_splits || context.expired();
  Flattened found;
  if (!last_resort) {
    const std::optional<OpenedPiece> opened =
        open_region(surface, faces, cut_sides, options, context);
    if (opened) found = flatten_region(*opened, options.flatten, context);
    if (opened && found.parts.empty()) {
      const auto tipped =
          open_to_tip(opened->piece, prediction_limit(options.flatten), options, context);
      if (tipped) found = flatten_region(*tipped, options.flatten, context);
    }
  }
  if (found.parts.empty() && (last_resort || context.expired())) {
    found.parts = project_to_planes(surface, faces, options.flatten);
  } else if (found.parts.empty()) {
    found.left_over = normal_halves(surface, faces, context);
  }
  for (Flattening& flat : found.parts) solved.push_back(std::move(flat));
  const int rest = static_cast<int>(found.left_over.size());
  std::vector<std::vector<Flattening>> more(rest);
  parallel_for(context, rest, [&](int i) {
    solve_split(surface, found.left_over[i], {}, splits + 1, options, context, more[i]);
  });
  for (int i = rest; i-- > 0;) {
    for (Flattening& flat : more[i]) solved.push_back(std::move(flat));
  }
}

}  // namespace

void solve_region(const Surface& surface, const std::vector<int32_t>& faces,
                  const std::vector<int32_t>& cut_sides, const SearchOptions& options,
                  const Context& context, std::vector<Flattening>& solved) {
  solve_split(surface, faces, cut_sides, 0, options, context, solved);
}

void rejoin(const Surface& surface, const std::vector<ChartState>& states,
            const SearchOptions& options, Context& context, std::vector<SolvedChart>& charts) {
  const double most_work_faces =
      options.merge_work_faces + options.merge_work_per_face * surface.face_count();
  if (most_work_faces == 0.0) return;
  const std::vector<double> weight;
  Evaluator evaluator(surface, weight, options, context);
  ChartSet regions(charts.size());
  std::unordered_map<int32_t, int32_t> chart_of_first;
  for (size_t c = 0; c < charts.size(); ++c) {
    regions[c].faces = charts[c].flattening.piece.source_face;
    std::sort(regions[c].faces.begin(), regions[c].faces.end());
    regions[c].part = charts[c].part;
    chart_of_first[regions[c].faces.front()] = static_cast<int32_t>(c);
  }
  const ChartSet before = regions;
  std::vector<char> movable;
  for (const ChartState state : states) movable.push_back(state != ChartState::settled);
  merge_charts(evaluator, regions, std::move(movable), most_work_faces);
  std::erase_if(regions, [&](const Chart& region) {
    return region.faces.size() == before[chart_of_first.at(region.faces.front())].faces.size();
  });
  std::vector<std::vector<Flattening>> merged =
      solve_regions(surface, regions, options, context, false);
  std::vector<char> replaced(charts.size(), 0);
  for (size_t r = 0; r < regions.size(); ++r) {
    if (merged[r].size() != 1) continue;
    for (int f : regions[r].faces) {
      const auto it = chart_of_first.find(f);
      if (it != chart_of_first.end()) replaced[it->second] = 1;
    }
    charts.push_back({std::move(merged[r].front()), regions[r].part});
    replaced.push_back(0);
  }
  std::vector<SolvedChart> kept;
  for (size_t c = 0; c < charts.size(); ++c) {
    if (!replaced[c]) kept.push_back(std::move(charts[c]));
  }
  charts = std::move(kept);
}

std::vector<SolvedChart> solve_charts(const Surface& surface, const ChartSet& regions,
                                      const SearchOptions& options, Context& context) {
  std::vector<std::vector<Flattening>> solved =
      solve_regions(surface, regions, options, context, true);
  std::vector<SolvedChart> charts;
  std::vector<ChartState> states;
  for (size_t i = 0; i < regions.size(); ++i) {
    for (Flattening& flat : solved[i]) {
      charts.push_back({std::move(flat), regions[i].part});
      // The larger part of a split region stays where it is; its fragments look for a new home.
      const size_t own = charts.back().flattening.piece.source_face.size();
      states.push_back(solved[i].size() == 1               ? ChartState::settled
                       : 2 * own > regions[i].faces.size() ? ChartState::changed
                                                           : ChartState::fragment);
    }
  }
  if (charts.size() > regions.size() && options.final_merge && !context.stopping()) {
    graft_fragments(surface, options, context, charts, states);
    rejoin(surface, states, options, context, charts);
  }

  return charts;
}

}  // namespace partuv
