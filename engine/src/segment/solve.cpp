#include "partuv/solve.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <unordered_map>

#include "segment/evaluator.hpp"
#include "segment/separate.hpp"

namespace partuv {
namespace {

/// Split a connected region in two: where its flattening lies on itself, between the two patches;
/// otherwise by its normals.
std::vector<std::vector<int32_t>> split_region(const Surface& surface,
                                               const std::vector<int32_t>& faces,
                                               const Flattening& failed, const Context& context) {
  std::vector<char> side;
  if (!failed.uv.empty() && failed.distortion.flipped == 0 && !failed.valid) {
    side = separate_overlap(failed);
  }
  if (side.empty()) return normal_halves(surface, faces, context);
  std::vector<int32_t> halves[2];
  for (size_t f = 0; f < faces.size(); ++f) halves[side[f] ? 0 : 1].push_back(faces[f]);
  std::vector<std::vector<int32_t>> parts;
  for (const auto& half : halves) {
    for (auto& part : connected_parts(surface, half)) parts.push_back(std::move(part));
  }
  return parts;
}

/// Flatten one region, splitting it as often as it takes.
void solve_region(const Surface& surface, const std::vector<int32_t>& faces,
                  const std::vector<int32_t>& cut_sides, const SearchOptions& options,
                  const Context& context, std::vector<Flattening>& solved) {
  constexpr int most_splits = 24;
  struct Open {
    std::vector<int32_t> faces;
    int splits;
  };
  std::vector<Open> open{{faces, 0}};
  while (!open.empty() && !context.cancelled()) {
    const Open region = std::move(open.back());
    open.pop_back();
    const bool last_resort =
        region.faces.size() == 1 || region.splits >= most_splits || context.expired();
    Flattening flat;
    if (!last_resort) {
      std::optional<OpenedPiece> opened;
      if (region.splits == 0 && !cut_sides.empty()) {
        CutSides cuts(3 * surface.faces.size(), 0);
        for (int h : cut_sides) cuts[h] = 1;
        Piece piece = extract_piece(surface, region.faces, {}, cuts);
        ConformalScale scale = predict_scale(piece, context);
        opened = OpenedPiece{std::move(piece), std::move(scale)};
      } else {
        opened = open_for_flattening(extract_piece(surface, region.faces, {}),
                                     prediction_limit(options.flatten), options, context);
      }
      if (opened) {
        flat = flatten(*opened, options.flatten, context);
        if (!flat.within && options.flatten.polish) {
          // The way of the search, which may end elsewhere.
          FlattenOptions quick = options.flatten;
          quick.quick = true;
          flat = flatten(std::move(*opened), quick, context);
        }
        if (flat.within) {
          solved.push_back(std::move(flat));
          continue;
        }
      }
    }
    if (last_resort || context.expired()) {
      for (Flattening& plane : project_to_planes(surface, region.faces, options.flatten)) {
        solved.push_back(std::move(plane));
      }
      continue;
    }
    for (auto& half : split_region(surface, region.faces, flat, context)) {
      open.push_back({std::move(half), region.splits + 1});
    }
  }
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

/// Pieces of split regions find new neighbours: merge them where the union still flattens.
void rejoin(const Surface& surface, const std::vector<char>& split, const SearchOptions& options,
            Context& context, std::vector<SolvedChart>& charts) {
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
  merge_charts(evaluator, regions, split);
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

}  // namespace

double mean_angular(const std::vector<SolvedChart>& charts) {
  double sum = 0.0, faces = 0.0;
  for (const SolvedChart& chart : charts) {
    const double count = chart.flattening.piece.surface.face_count();
    sum += count * chart.flattening.distortion.angular;
    faces += count;
  }
  return faces > 0.0 ? sum / faces : 1.0;
}

void raise_mean_angular(const Surface& surface, const SearchOptions& options, Context& context,
                        std::vector<SolvedChart>& charts) {
  for (const double area_weight : {0.06, 0.015}) {
    if (mean_angular(charts) >= options.min_mean_angular || context.stopping()) break;
    FlattenOptions lighter = options.flatten;
    lighter.area_weight = area_weight;
    parallel_for(context, static_cast<int>(charts.size()), [&](int c) {
      Flattening& kept = charts[c].flattening;
      if (kept.piece.surface.face_count() == 1 || context.stopping()) return;
      Flattening flat = flatten({kept.piece, predict_scale(kept.piece, context)}, lighter, context);
      if (flat.within && flat.distortion.angular > kept.distortion.angular) kept = std::move(flat);
    });
  }
  // Then halve the chart that pulls the mean down most, as often as it takes.
  const auto pull = [&](const SolvedChart& chart) {
    const int faces = chart.flattening.piece.surface.face_count();
    return faces > 1 ? faces * (options.min_mean_angular - chart.flattening.distortion.angular)
                     : 0.0;
  };
  while (mean_angular(charts) < options.min_mean_angular && !context.stopping()) {
    const auto worst = std::max_element(
        charts.begin(), charts.end(),
        [&](const SolvedChart& a, const SolvedChart& b) { return pull(a) < pull(b); });
    if (!(pull(*worst) > 0.0)) break;
    split_charts(surface, {static_cast<int32_t>(worst - charts.begin())}, options, false, context,
                 charts);
  }
}

std::vector<SolvedChart> solve_charts(const Surface& surface, const ChartSet& regions,
                                      const SearchOptions& options, Context& context) {
  std::vector<std::vector<Flattening>> solved =
      solve_regions(surface, regions, options, context, true);
  std::vector<SolvedChart> charts;
  std::vector<char> split;
  for (size_t i = 0; i < regions.size(); ++i) {
    for (Flattening& flat : solved[i]) {
      charts.push_back({std::move(flat), regions[i].part});
      // The larger part of a split region stays where it is; its fragments look for a new home.
      const size_t own = charts.back().flattening.piece.source_face.size();
      split.push_back(2 * own <= regions[i].faces.size());
    }
  }
  const bool any_split = std::find(split.begin(), split.end(), 1) != split.end();
  if (any_split && options.final_merge && !context.stopping()) {
    rejoin(surface, split, options, context, charts);
  }

  raise_mean_angular(surface, options, context, charts);
  return charts;
}

void split_charts(const Surface& surface, const std::vector<int32_t>& which,
                  const SearchOptions& options, bool to_faces, const Context& context,
                  std::vector<SolvedChart>& charts) {
  std::vector<char> replaced(charts.size(), 0);
  for (const int c : which) {
    replaced[c] = 1;
    std::vector<int32_t> faces = charts[c].flattening.piece.source_face;
    std::sort(faces.begin(), faces.end());
    std::vector<Flattening> parts;
    if (to_faces) {
      for (const int f : faces) {
        for (Flattening& single : project_to_planes(surface, {f}, options.flatten)) {
          parts.push_back(std::move(single));
        }
      }
    } else {
      for (const auto& half : normal_halves(surface, faces, context)) {
        solve_region(surface, half, {}, options, context, parts);
      }
    }
    const int32_t part = charts[c].part;
    for (Flattening& flat : parts) charts.push_back({std::move(flat), part});
  }
  std::vector<SolvedChart> kept;
  for (size_t c = 0; c < charts.size(); ++c) {
    if (c >= replaced.size() || !replaced[c]) kept.push_back(std::move(charts[c]));
  }
  charts = std::move(kept);
}

}  // namespace partuv
