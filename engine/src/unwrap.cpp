#include "partuv/unwrap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>

#include "assemble.hpp"
#include "effort.hpp"
#include "find_charts.hpp"
#include "partuv/denoise.hpp"
#include "partuv/pack.hpp"
#include "partuv/parts.hpp"
#include "partuv/search.hpp"
#include "partuv/simplify.hpp"
#include "partuv/solve.hpp"
#include "partuv/topology.hpp"
#include "segment/evaluator.hpp"
#include "segment/graft.hpp"
#include "segment/shorten.hpp"
#include "single_precision.hpp"
#include "stages.hpp"

namespace partuv {
namespace {

Result<bool> check_options(const Options& o) {
  if (!(o.max_area_distortion > 1.0 && o.max_area_distortion <= 10.0)) {
    return Failure{Error::invalid_option, "max_area_distortion"};
  }
  if (!(o.min_angular >= 0.0 && o.min_angular < 1.0)) {
    return Failure{Error::invalid_option, "min_angular"};
  }
  if (!(o.denoise <= 10.0)) return Failure{Error::invalid_option, "denoise"};
  if (!(o.cut_below_efficiency >= 0.0 && o.cut_below_efficiency < 1.0)) {
    return Failure{Error::invalid_option, "cut_below_efficiency"};
  }
  if (o.parts < searched_parts) return Failure{Error::invalid_option, "parts"};
  for (double weight : o.texel_weights.face) {
    if (!(weight > 0.0)) return Failure{Error::invalid_option, "texel_weights"};
  }
  return check_pack_options(o);
}

SearchOptions search_options(const Options& o, const Effort& effort, const Ablation& ablation,
                             const Topology& topology) {
  SearchOptions search;
  search.flatten.max_area_distortion = o.max_area_distortion;
  if (o.profile == Profile::balanced) {
    search.min_mean_angular = search.flatten.min_angular = o.min_angular;
  } else {
    search.min_mean_angular = search.flatten.min_angular = 0.0;
  }
  search.flatten.polish = ablation.polish && o.profile == Profile::balanced;
  search.flatten.angle_based = o.flattening == Flattener::abf;
  search.flatten.least_area = least_area(topology.surface);
  search.flatten.spread_steps = effort.spread_steps;
  search.flatten.quick = !effort.full_polish;
  search.flatten.patience = effort.patience;
  search.most_searches = effort.searches;
  search.merge_work_faces *= effort.merging;
  search.merge_work_per_face *= effort.merging;
  search.merge_heuristic = ablation.merge_heuristic;
  search.most_normal_charts = effort.normal_charts;
  search.recursion = effort.recursion || ablation.recursion;
  search.final_merge = ablation.final_merge;
  search.cut_open = ablation.cut_open;
  search.fixed_parts = ablation.fixed_parts;
  return search;
}

/// A surface as it is, as a proxy.
Proxy as_fine(Surface surface) {
  Proxy proxy;
  proxy.proxy_of_face.resize(surface.faces.size());
  std::iota(proxy.proxy_of_face.begin(), proxy.proxy_of_face.end(), 0);
  proxy.surface = std::move(surface);
  return proxy;
}

/// smooth: the denoised copy of the surface; it is simplified to so many faces.
StandIn make_stand_in(const Surface& surface, Surface smooth, double noise, int faces,
                      const Context& context) {
  StandIn made;
  const bool coarser = smooth.face_count() > faces;
  made.exact = !coarser && smooth.positions == surface.positions;
  SimplifyOptions simplification;
  simplification.target_faces = faces;
  // Simplifying is serial for the most part; the other threads weigh sides for later.
  parallel_for(context, made.exact ? 1 : 2, [&](int i) {
    if (i == 1) {
      made.side_weights = weigh_sides(surface, noise, context);
    } else if (coarser) {
      made.proxy = simplify(smooth, simplification, context);
    } else {
      made.proxy = as_fine(std::move(smooth));
    }
  });
  return made;
}

/// The number that each chart's part will have in the atlas: it does not depend on the places.
std::vector<int32_t> atlas_parts(const Mesh& mesh, const Topology& topology,
                                 const std::vector<SolvedChart>& solved,
                                 const std::vector<int32_t>& labels, double least_area) {
  Packing nowhere;
  nowhere.placements.resize(solved.size());
  Atlas draft;
  assemble(mesh, topology, solved, nowhere, least_area, draft);
  write_parts(topology, labels, draft);
  std::vector<int32_t> part;
  for (const ChartFigures& chart : draft.charts) part.push_back(chart.part);
  return part;
}

/// The texel density of each chart relative to others.
Result<std::vector<double>> chart_weights(const TexelWeights& weights, const Mesh& mesh,
                                          const Topology& topology,
                                          const std::vector<SolvedChart>& solved,
                                          const std::vector<int32_t>& labels, double least_area) {
  std::vector<double> weight(solved.size(), 1.0);
  for (size_t c = 0; c < solved.size() && !weights.face.empty(); ++c) {
    weight[c] = 0.0;
    for (int f : solved[c].flattening.piece.source_face) {
      weight[c] = std::max(weight[c], weights.face[topology.source_face[f]]);
    }
  }
  if (weights.part.empty()) return weight;
  const std::vector<int32_t> part = atlas_parts(mesh, topology, solved, labels, least_area);
  const int32_t last = *std::max_element(part.begin(), part.end());
  for (const auto& [number, factor] : weights.part) {
    if (number < 0 || number > last) {
      return Failure{Error::invalid_option, "texel_weights: there is no part " +
                                                std::to_string(number) + ", the last is " +
                                                std::to_string(last)};
    }
    for (size_t c = 0; c < part.size(); ++c) {
      if (part[c] == number) weight[c] *= factor;
    }
  }
  return weight;
}

/// What the packer sees of the charts. Parts come in the order of the tree's leaves.
std::vector<PackChart> outlines(const std::vector<SolvedChart>& solved, const Proxy& proxy,
                                const PartTree& tree, const std::vector<double>& weight) {
  std::vector<int32_t> place(tree.order.size());
  for (size_t i = 0; i < tree.order.size(); ++i) place[tree.order[i]] = static_cast<int32_t>(i);
  std::map<int32_t, int32_t> first;  // place of each part
  for (const SolvedChart& chart : solved) {
    int32_t& least =
        first.try_emplace(chart.part, std::numeric_limits<int32_t>::max()).first->second;
    for (int f : chart.flattening.piece.source_face) {
      least = std::min(least, place[proxy.proxy_of_face[f]]);
    }
  }
  std::vector<PackChart> charts;
  charts.reserve(solved.size());
  for (size_t c = 0; c < solved.size(); ++c) {
    const SolvedChart& chart = solved[c];
    charts.push_back({chart.flattening.uv, chart.flattening.piece.surface.faces, chart.part,
                      first[chart.part], weight[c]});
  }
  return charts;
}

/// The options in the units of the surface, whose area is 1.
PackOptions pack_options(const Options& o, const Effort& effort, const Topology& topology) {
  PackOptions pack = o;
  pack.effort *= effort.packing;
  pack.texel_density *= std::sqrt(topology.area);
  return pack;
}

/// Of the charts' own units, where they are written the smallest.
double rounding_step(const Packing& packing) {
  double least_scale = std::numeric_limits<double>::infinity();
  for (const Placement& place : packing.placements) {
    least_scale = std::min(least_scale, place.scale);
  }
  return std::ldexp(1.0, -packing.grid_bits) / least_scale;
}

/// Mean angular score of the atlas as written, over the caller's faces.
double delivered_angular(const Atlas& atlas) {
  double sum = 0.0, faces = 0.0;
  for (const ChartFigures& chart : atlas.charts) {
    sum += chart.face_count * chart.angular;
    faces += chart.face_count;
  }
  return faces > 0.0 ? sum / faces : 1.0;
}

/// One unwrap with a given effort; span: of the progress that it takes.
Result<Atlas> unwrap_once(const Mesh& mesh, const PartPrior& prior, const Options& options,
                          const Effort& effort, const Span& span, Context& context,
                          const Ablation& ablation) {
  if (const Result<bool> fine = check_options(options); !fine) return fine.failure();
  const size_t weighted = options.texel_weights.face.size();
  if (weighted != 0 && weighted != mesh.faces.size()) {
    return Failure{Error::invalid_option, "texel_weights"};
  }
  Atlas atlas;
  Stages stages(context, atlas, span);

  stages.enter("topology", 0.0, 0.02);
  Result<Topology> built = build_topology(mesh, context, Numbering::canonical);
  if (!built) return built.failure();
  const Topology& topology = built.value();

  stages.enter("simplifying", 0.02, 0.08);
  Surface smooth = topology.surface;
  const Noise noise = estimate_noise_by_component(topology.surface);
  atlas.noise = noise.whole;
  if (options.denoise < 0.0) {
    smooth.positions = denoise_auto(topology.surface, noise, context);
  } else if (options.denoise > 0.0) {
    smooth.positions = denoise(topology.surface, options.denoise, context);
  }
  const Surface decided = options.parts == searched_parts ? Surface{} : smooth;
  constexpr int unbounded = std::numeric_limits<int>::max();
  const StandIn stand_in = make_stand_in(topology.surface, std::move(smooth), noise.whole,
                                         ablation.proxy ? effort.proxy_faces : unbounded, context);
  const Proxy& proxy = stand_in.proxy;
  if (context.cancelled()) return Failure{Error::cancelled, "simplifying"};
  atlas.proxy_faces = proxy.surface.face_count();

  stages.enter("parts", 0.08, 0.12);
  Result<PartTree> built_tree = build_part_tree(prior, topology, proxy, context);
  if (!built_tree) return built_tree.failure();
  std::vector<PartTree> trees{std::move(built_tree.value())};
  const std::vector<int32_t> parts =
      choose_parts(options.parts, prior, decided, proxy, trees.front(), context);
  if (effort.second_tree && !prior.tree && prior.dimensions == 0) {
    if (auto second = normals_tree(proxy.surface, context)) trees.push_back(std::move(*second));
  }
  const SearchOptions search = search_options(options, effort, ablation, topology);
  std::vector<SearchOptions> searches{search};
  if (effort.deeper_slits) {
    searches.push_back(search);
    searches.back().most_slits *= 3;
  }
  std::vector<SolvedChart> solved = find_charts(topology.surface, stand_in, trees, searches, stages,
                                                context, atlas.searched_charts);
  if (context.cancelled()) return Failure{Error::cancelled, ""};
  assign_parts(topology.surface, parts, solved);
  const auto weigh = [&] {
    return chart_weights(options.texel_weights, mesh, topology, solved, parts,
                         search.flatten.least_area);
  };
  const Result<std::vector<double>> whole_weights = weigh();
  if (!whole_weights) return whole_weights.failure();
  shorten_charts(options, search.flatten, whole_weights.value(), context, solved);

  // The proof is made on the coordinates as written; what fails there is flattened anew, or split,
  // and packed again.
  SearchOptions repairs = search;
  repairs.flatten.min_angular = chart_angular(search, loosest_share);
  // What is tightened or split may fail where it lies next; in the end only splitting goes on,
  // which comes to an end.
  constexpr int most_tightenings = 3, last_raise = 4, most_splits = 12;
  for (int repair = 0;; ++repair) {
    stages.enter("packing", 0.9, 0.99);
    fit_to_single_precision(solved);
    assign_parts(topology.surface, parts, solved);
    const Result<std::vector<double>> weights = weigh();
    if (!weights) return weights.failure();
    const Result<Packing> packed = pack(outlines(solved, proxy, trees.front(), weights.value()),
                                        pack_options(options, effort, topology), context);
    if (context.cancelled()) return Failure{Error::cancelled, ""};
    if (!packed) return packed.failure();
    const Packing& packing = packed.value();
    repairs.rounding_step = rounding_step(packing);
    atlas.efficiency = packing.efficiency;
    atlas.tiles = packing.tiles;
    stages.enter("checking", 0.99, 1.0);
    assemble(mesh, topology, solved, packing, search.flatten.least_area, atlas);
    write_parts(topology, parts, atlas);
    std::vector<ChartExcess> failed = charts_to_repair(
        topology, solved, atlas, search.flatten.least_area, options.max_area_distortion);
    // The paper's angular score depends on how the charts lie: what is missing is asked for on top.
    const double missing = search.min_mean_angular - delivered_angular(atlas);
    const bool raises = missing > 0.0 && repair <= last_raise && !context.stopping();
    if (failed.empty() && !raises) break;
    // What fails mostly lacks angles as well, which the others need not make up for.
    const bool raises_now = raises && (failed.empty() || repair == last_raise);
    if (repair < most_tightenings) {
      failed = tighten_charts(std::move(failed), repairs, context, solved);
    }
    const size_t old = solved.size() - failed.size();
    split_charts(topology.surface, failed, repairs, repair >= most_splits, context, solved);
    if (search.final_merge && repair <= last_raise) {
      hang_slivers(topology.surface, repairs, context, old, solved);
    }
    if (raises_now) {
      SearchOptions stricter = repairs;
      stricter.min_mean_angular = std::min(mean_angular(solved) + missing + 0.001, 0.999);
      raise_mean_angular(topology.surface, stricter, context, solved);
    }
  }
  stages.finish();
  context.advance(1.0);
  return atlas;
}

}  // namespace

Result<Atlas> unwrap(const Mesh& mesh, const PartPrior& prior, const Options& options,
                     Context& context, const Ablation& ablation) {
  const Effort effort = effort_of(options.quality);
  if (options.quality != Quality::best) {
    return unwrap_once(mesh, prior, options, effort, {}, context, ablation);
  }
  // A longer search mostly finds fewer charts, not always: the usual one is the fallback.
  constexpr double usual_share = 0.2;
  Effort usual = effort_of(Quality::standard);
  usual.packing = effort.packing;
  Result<Atlas> fallback =
      unwrap_once(mesh, prior, options, usual, {0.0, usual_share}, context, ablation);
  if (!fallback || context.stopping()) return fallback;
  Result<Atlas> thorough =
      unwrap_once(mesh, prior, options, effort, {usual_share, 1.0}, context, ablation);
  if (!thorough) return thorough;
  Result<Atlas>*kept = &thorough, *other = &fallback;
  if (fallback.value().charts.size() < thorough.value().charts.size()) std::swap(kept, other);
  for (auto& [name, seconds] : kept->value().stage_seconds) {
    for (const auto& [same, more] : other->value().stage_seconds) {
      if (same == name) seconds += more;
    }
  }
  return std::move(*kept);
}

}  // namespace partuv
