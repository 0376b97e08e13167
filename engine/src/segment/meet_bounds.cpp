// What is done about charts that keep their own bounds while the atlas does not.
#include <algorithm>
#include <array>
#include <utility>

#include "partuv/solve.hpp"
#include "segment/evaluator.hpp"
#include "segment/solve_region.hpp"

namespace partuv {
namespace {

std::vector<Flattening> solved_halves(const Surface& surface, const SolvedChart& chart,
                                      const SearchOptions& options, const Context& context) {
  std::vector<int32_t> faces = chart.flattening.piece.source_face;
  std::sort(faces.begin(), faces.end());
  std::vector<Flattening> parts;
  for (const auto& half : normal_halves(surface, faces, context)) {
    solve_region(surface, half, {}, options, context, parts);
  }
  return parts;
}

/// What is left of a chart, as it lies, without some faces, and each of those on its own. lost:
/// ascending.
std::vector<Flattening> without(const Surface& surface, const Flattening& flat,
                                const std::vector<int32_t>& lost, const SearchOptions& options,
                                const Context& context) {
  std::vector<Flattening> parts;
  for (const int f : lost) {
    for (Flattening& single : project_to_planes(surface, {f}, options.flatten)) {
      parts.push_back(std::move(single));
    }
  }
  const std::vector<int32_t>& source = flat.piece.source_face;
  std::vector<int32_t> rest;
  for (size_t i = 0; i < source.size(); ++i) {
    if (!std::binary_search(lost.begin(), lost.end(), source[i])) {
      rest.push_back(static_cast<int32_t>(i));
    }
  }
  for (auto& part : connected_parts(flat.piece.surface, rest)) {
    Flattening kept = restricted(flat, part, options.flatten);
    if (kept.within) {
      parts.push_back(std::move(kept));
      continue;
    }
    for (int32_t& f : part) f = source[f];
    std::sort(part.begin(), part.end());
    solve_region(surface, part, {}, options, context, parts);
  }
  return parts;
}

/// Put the parts of charts in their place; they come last.
void replace_charts(std::vector<std::pair<int32_t, std::vector<Flattening>>> parts_of,
                    std::vector<SolvedChart>& charts) {
  std::vector<char> replaced(charts.size(), 0);
  for (const auto& [c, unused] : parts_of) replaced[c] = 1;
  std::vector<SolvedChart> kept;
  for (size_t c = 0; c < charts.size(); ++c) {
    if (!replaced[c]) kept.push_back(std::move(charts[c]));
  }
  for (auto& [c, parts] : parts_of) {
    for (Flattening& flat : parts) kept.push_back({std::move(flat), charts[c].part});
  }
  charts = std::move(kept);
}

int face_sum(const std::vector<SolvedChart>& charts) {
  int faces = 0;
  for (const SolvedChart& chart : charts) faces += chart.flattening.piece.surface.face_count();
  return faces;
}

/// A chart in halves, and what they add to the sum of angular scores.
struct Halving {
  int32_t chart;
  std::vector<int32_t> faces;  ///< of the chart
  std::vector<Flattening> parts;
  double gain = 0.0;
};

/// Of the charts that pull the mean below `aim` most, the one whose halves add most to the sum for
/// each chart more. More than `wanted` is no use. None where no chart is below. known: what was
/// tried before, instead of which what was tried now is left there.
std::optional<Halving> best_halving(const Surface& surface, const std::vector<SolvedChart>& charts,
                                    double aim, double wanted, const SearchOptions& options,
                                    const Context& context, std::vector<Halving>& known) {
  constexpr size_t most_tried = 6;
  std::vector<std::pair<double, int32_t>> pulls;
  for (size_t c = 0; c < charts.size(); ++c) {
    const Flattening& flat = charts[c].flattening;
    const int faces = flat.piece.surface.face_count();
    const double pull = faces * aim - angular_sum(flat);
    if (faces > 1 && pull > 0.0) pulls.emplace_back(-pull, static_cast<int32_t>(c));
  }
  if (pulls.empty()) return std::nullopt;
  std::sort(pulls.begin(), pulls.end());
  pulls.resize(std::min(pulls.size(), most_tried));
  std::vector<Halving> halvings(pulls.size());
  for (size_t i = 0; i < pulls.size(); ++i) {
    const std::vector<int32_t>& faces = charts[pulls[i].second].flattening.piece.source_face;
    const auto same =
        std::find_if(known.begin(), known.end(), [&](auto& h) { return h.faces == faces; });
    if (same != known.end()) halvings[i] = std::move(*same);
    halvings[i].faces = faces;
    halvings[i].chart = pulls[i].second;
  }
  parallel_for(context, static_cast<int>(pulls.size()), [&](int i) {
    Halving& halving = halvings[i];
    if (!halving.parts.empty()) return;
    const SolvedChart& whole = charts[halving.chart];
    halving.parts = solved_halves(surface, whole, options, context);
    halving.gain = -angular_sum(whole.flattening);
    for (const Flattening& part : halving.parts) halving.gain += angular_sum(part);
  });
  const auto worth = [&](const Halving& halving) {
    return std::min(halving.gain, wanted) / static_cast<double>(halving.parts.size());
  };
  const auto best =
      std::max_element(halvings.begin(), halvings.end(),
                       [&](const Halving& a, const Halving& b) { return worth(a) < worth(b); });
  Halving result = std::move(*best);
  halvings.erase(best);
  known = std::move(halvings);
  return result;
}

}  // namespace

double mean_angular(const std::vector<SolvedChart>& charts) {
  double sum = 0.0;
  for (const SolvedChart& chart : charts) sum += angular_sum(chart.flattening);
  const int faces = face_sum(charts);
  return faces > 0 ? sum / faces : 1.0;
}

namespace {

constexpr std::array area_weights{0.06, 0.015, 0.12, 0.03};
constexpr size_t long_strides = 2;

/// With which weights a chart has been flattened anew, uncut and cut open to a tip.
struct Tried {
  std::array<bool, area_weights.size()> uncut{}, tipped{};
};

/// While the mean angular score is below `aim`: polish with less regard for area, within the bounds
/// of each chart. tried: per chart; may be called again, as charts that are cut open further have
/// new ways.
void favour_angles(const SearchOptions& options, double aim, const Context& context,
                   std::vector<SolvedChart>& charts, std::vector<Tried>& tried) {
  // What rises by less rises by rounding.
  constexpr double least_rise = 1e-6;
  // The long strides first; the short ones are for charts whose area does not let them go so far,
  // which the quick way makes little of.
  const size_t strides = options.flatten.quick ? long_strides : area_weights.size();
  for (size_t w = 0; w < strides; ++w) {
    if (mean_angular(charts) >= aim || context.stopping()) break;
    FlattenOptions lighter = options.flatten;
    lighter.area_weight = area_weights[w];
    parallel_for(context, static_cast<int>(charts.size()), [&](int c) {
      Flattening& kept = charts[c].flattening;
      if (kept.piece.surface.face_count() == 1 || context.stopping()) return;
      const auto better = [&](OpenedPiece opened) {
        Flattening flat = flatten(std::move(opened), lighter, context);
        const bool found =
            flat.within && flat.distortion.angular > kept.distortion.angular + least_rise;
        if (found) kept = std::move(flat);
        return found;
      };
      if (!std::exchange(tried[c].uncut[w], true) &&
          better({kept.piece, predict_scale(kept.piece, context)})) {
        return;
      }
      if (std::exchange(tried[c].tipped[w], true)) return;
      auto tipped = open_to_tip(kept.piece, prediction_limit(options.flatten), options, context);
      if (tipped && better(std::move(*tipped))) tried[c] = {};
    });
  }
}

}  // namespace

std::vector<ChartExcess> tighten_charts(std::vector<ChartExcess> excesses,
                                        const SearchOptions& options, const Context& context,
                                        std::vector<SolvedChart>& charts) {
  std::vector<char> done(excesses.size(), 0);
  parallel_for(context, static_cast<int>(excesses.size()), [&](int i) {
    Flattening& kept = charts[excesses[i].chart].flattening;
    // More than is missing, as rounding will not do quite the same again.
    constexpr double reserve = 1.5, least_reserve = 0.002, angular_cost = 0.01;
    const double missing = excesses[i].area_distortion - options.flatten.max_area_distortion;
    if (missing <= 0.0) return;
    FlattenOptions tighter = options.flatten;
    tighter.max_area_distortion = kept.distortion.area - reserve * missing - least_reserve;
    tighter.min_angular = std::min(tighter.min_angular, kept.distortion.angular - angular_cost);
    for (const double area_weight : {0.5, 1.0}) {
      tighter.area_weight = area_weight;
      Flattening flat = flatten({kept.piece, predict_scale(kept.piece, context)}, tighter, context);
      if (!flat.within) continue;
      kept = std::move(flat);
      done[i] = 1;
      return;
    }
  });
  std::vector<ChartExcess> left;
  for (size_t i = 0; i < excesses.size(); ++i) {
    if (!done[i]) left.push_back(std::move(excesses[i]));
  }
  return left;
}

double raise_mean_angular(const Surface& surface, const SearchOptions& options, Context& context,
                          std::vector<SolvedChart>& charts, double reserve) {
  const double aim = options.min_mean_angular;
  std::vector<Tried> tried(charts.size());
  favour_angles(options, aim + reserve, context, charts, tried);
  const double missing = aim - mean_angular(charts);
  favour_angles(options, aim + reserve, context, charts, tried);
  SearchOptions strict = options;
  strict.flatten.min_angular = aim;
  std::vector<Halving> known;
  while (mean_angular(charts) < aim && !context.stopping()) {
    const double wanted = (aim - mean_angular(charts)) * face_sum(charts);
    auto halving = best_halving(surface, charts, aim, wanted, options, context, known);
    if (!halving || context.cancelled()) break;
    const size_t others = charts.size() - 1;
    std::vector<std::pair<int32_t, std::vector<Flattening>>> parts_of;
    parts_of.emplace_back(halving->chart, std::move(halving->parts));
    replace_charts(std::move(parts_of), charts);
    // What is good enough in fewer charts.
    std::vector<ChartState> states(charts.size(), ChartState::settled);
    std::fill(states.begin() + others, states.end(), ChartState::fragment);
    if (options.final_merge) rejoin(surface, states, strict, context, charts);
  }
  return missing;
}

void split_charts(const Surface& surface, const std::vector<ChartExcess>& which,
                  const SearchOptions& options, bool to_faces, const Context& context,
                  std::vector<SolvedChart>& charts) {
  std::vector<std::pair<int32_t, std::vector<Flattening>>> parts_of;
  for (const ChartExcess& excess : which) {
    const SolvedChart& chart = charts[excess.chart];
    const std::vector<int32_t>& all = chart.flattening.piece.source_face;
    std::vector<int32_t> lost = to_faces ? all : excess.lost_faces;
    std::sort(lost.begin(), lost.end());
    parts_of.emplace_back(
        excess.chart, lost.empty() ? solved_halves(surface, chart, options, context)
                                   : without(surface, chart.flattening, lost, options, context));
  }
  replace_charts(std::move(parts_of), charts);
}

}  // namespace partuv
