#include "partuv/flatten.hpp"

#include <algorithm>
#include <cmath>

#include "flatten/system.hpp"
#include "planar.hpp"

namespace partuv {
namespace {

/// True if some face is flipped or no higher than `least_height`, a share of its longest side.
bool has_flip(const Piece& piece, const std::vector<Vec2>& uv, double least_height = 0.0) {
  for (const Triangle& t : piece.surface.faces) {
    double square = 0.0;
    for (int k = 0; k < 3; ++k) {
      square = std::max(square, (uv[t[(k + 1) % 3]] - uv[t[k]]).squaredNorm());
    }
    if (!(turn(uv[t[0]], uv[t[1]], uv[t[2]]) > least_height * square)) return true;
  }
  return false;
}

/// Starting map: the rigid unfolding where it is exact, else angle-based or least-squares
/// conformal, with flipped faces turned over; Tutte's where that fails.
std::vector<Vec2> starting_layout(const OpenedPiece& opened, const std::vector<RestTriangle>& rest,
                                  const FlattenOptions& options, const Context& context,
                                  MeshSystem<2>& system) {
  constexpr int angle_steps = 3;
  constexpr double exact = 1e-5;
  // Scaling a map could flip a thinner face, and no energy is finite there.
  constexpr double thinnest = 1e-12;
  const Piece& piece = opened.piece;
  const auto distortion = [&](const std::vector<Vec2>& uv) {
    return uv.empty() || has_flip(piece, uv, thinnest) ? Distortion{10.0, 0.0}
                                                       : measure(piece, uv, options.least_area);
  };
  const std::vector<RestTriangle> flat = scaled_shapes(piece.surface, opened.scale.log_scale);
  std::vector<Vec2> unfolded = unfolded_layout(piece, flat);
  const Distortion rigid = distortion(unfolded);
  if (rigid.area <= 1.0 + exact && rigid.angular >= 1.0 - exact) return unfolded;
  // For the polish, which only needs to start near, the predicted scale saves the angle solves.
  std::vector<Vec2> uv =
      conformal_layout(piece,
                       options.quick && options.polish ? flat
                       : options.angle_based ? angle_based_shapes(piece, rest, angle_steps, context)
                                             : rest,
                       context, system);
  // On long strips of few faces across, conformal maps whose scale grows exponentially have hardly
  // any energy, and the solve cannot tell them from the right one.
  const Distortion conformal = distortion(uv);
  const auto badness = [](const Distortion& d) { return d.area - 1.0 + 4.0 * (1.0 - d.angular); };
  if (badness(rigid) < 0.5 * badness(conformal)) return unfolded;
  if (conformal.angular > 0.0) return uv;
  if (!options.polish) return {};
  PolishOptions turning;
  if (!options.quick) turning.steps *= options.patience;
  turning.area_weight = options.area_weight;
  turning.least_area = options.least_area;
  if (!uv.empty() && untangle(piece, rest, turning, context, system, uv)) return uv;
  uv = tutte_layout(piece, context);
  if (!uv.empty() && has_flip(piece, uv)) uv.clear();
  return uv;
}

/// Polishes a starting map along the curve between angle and area until both bounds hold, or
/// neither can. Returns the last map within the bounds that does not overlap, or the last one of
/// all. overlapping: the map lies on itself and will go on to.
std::vector<Vec2> polish_to_bounds(const Piece& piece, const std::vector<RestTriangle>& rest,
                                   const FlattenOptions& options, bool overlapping,
                                   const Context& context, MeshSystem<2>& system,
                                   std::vector<Vec2> uv) {
  // A map that meets the bounds mostly does so after a step or two; most that never will have shown
  // it after a few.
  const int most_weightings = options.quick ? 3 : 4;
  PolishOptions weights;
  weights.steps = options.quick ? std::min(options.steps, 8) : options.steps;
  weights.area_weight = options.area_weight;
  weights.least_area = options.least_area;
  scale_to_area(piece, rest, uv);
  // By then a map that will keep the bounds has come near them. Some parts with needles do much
  // later, and the patience is for them.
  constexpr int hopeful_steps = 6;
  // Less regard for area seldom gains more: of 2,089 maps that settled further below their angular
  // bound, 24 came to keep it.
  constexpr double most_angular_gain = 0.01;
  std::vector<Vec2> good;
  const auto measured = [&](const std::vector<Vec2>& map) {
    return measure(piece, map, options.least_area);
  };
  const auto keeps_to = [&](const std::vector<Vec2>& map, const Distortion& d) {
    // Faces too small to be measured must not be turned over either.
    return keeps_bounds(d, options) && !has_flip(piece, map);
  };
  int asked = 0;
  bool hopeless = false;
  const auto enough = [&] {
    const Distortion d = measured(uv);
    hopeless = options.quick && ++asked > hopeful_steps && stretches_hopelessly(d, options);
    if (hopeless) return true;
    if (!keeps_to(uv, d)) return false;
    if (overlapping) return true;
    if (boundary_is_simple(piece, uv)) {
      good = uv;
      return options.quick;
    }
    std::vector<Vec2> inset = inset_boundary(piece, uv);
    if (!keeps_to(inset, measured(inset)) || !boundary_is_simple(piece, inset)) return false;
    good = std::move(inset);
    return options.quick;
  };
  for (int weighting = 0; weighting < most_weightings && !context.stopping(); ++weighting) {
    bool settled = polish(piece, rest, weights, enough, context, system, uv);
    for (int more = 1; more < options.patience && !settled && !options.quick && good.empty();
         ++more) {
      settled = polish(piece, rest, weights, enough, context, system, uv);
    }
    if (hopeless) return uv;
    if (enough() || !good.empty()) break;
    const Distortion d = measured(uv);
    const bool area_holds = d.area <= options.max_area_distortion;
    if (area_holds == (d.angular >= options.min_angular)) break;
    if (options.quick && area_holds && d.angular < options.min_angular - most_angular_gain) break;
    weights.area_weight *= area_holds ? 0.3 : 3.0;
  }
  if (!good.empty()) return good;
  if (overlapping || !keeps_to(uv, measured(uv))) return uv;
  std::vector<Vec2> apart = uv;
  const auto lost = [&] { return !keeps_to(apart, measured(apart)); };
  const bool spread =
      spread_apart(piece, rest, weights, options.spread_steps, lost, context, system, apart);
  return spread && !lost() ? apart : uv;
}

}  // namespace

bool keeps_bounds(const Distortion& d, const FlattenOptions& options) {
  return d.flipped == 0 && d.area <= options.max_area_distortion &&
         d.angular >= options.min_angular;
}

bool stretches_hopelessly(const Distortion& d, const FlattenOptions& options) {
  // Of 1,356 maps that were further beyond a bound of 1.25 after six quick steps, five came to keep
  // it; of 122 that ended further beyond it, another start brought two there.
  constexpr double most_excess = 1.25;
  return d.flipped == 0 && d.area > options.max_area_distortion + most_excess;
}

Flattening judged(Piece piece, std::vector<Vec2> uv, const FlattenOptions& options) {
  Flattening result;
  result.distortion = measure(piece, uv, options.least_area);
  result.valid = !has_flip(piece, uv) && boundary_is_simple(piece, uv);
  result.within = result.valid && keeps_bounds(result.distortion, options);
  result.uv = std::move(uv);
  result.piece = std::move(piece);
  return result;
}

Flattening flatten(OpenedPiece opened, const FlattenOptions& options, const Context& context) {
  const Piece& p = opened.piece;
  if (p.component_count != 1 || p.loops.empty() || p.genus() != 0) return {};
  const std::vector<RestTriangle> rest = rest_shapes(p.surface);
  MeshSystem<2> system(p.surface.faces, p.surface.vertex_count());
  std::vector<Vec2> uv = starting_layout(opened, rest, options, context, system);
  if (uv.empty()) return {};
  // The polish changes little about what lies where.
  const bool overlapping = options.quick && overlaps_widely(p, uv);
  if (overlapping && !options.to_cut_apart) return {};
  if (options.polish) {
    uv = polish_to_bounds(p, rest, options, overlapping, context, system, std::move(uv));
  }
  return judged(std::move(opened.piece), std::move(uv), options);
}

Flattening restricted(const Flattening& flattening, const std::vector<int32_t>& faces,
                      const FlattenOptions& options) {
  const Piece& whole = flattening.piece;
  Piece piece = extract_piece(whole.surface, faces, whole.weight);
  std::vector<Vec2> uv;
  for (const int v : piece.source_vertex) uv.push_back(flattening.uv[v]);
  for (int32_t& v : piece.source_vertex) v = whole.source_vertex[v];
  for (int32_t& f : piece.source_face) f = whole.source_face[f];
  return judged(std::move(piece), std::move(uv), options);
}

}  // namespace partuv
