#include <algorithm>

#include "segment/evaluator.hpp"
#include "segment/runs.hpp"

namespace partuv {
namespace {

/// Sides of `a` that face `b`, and theirs, those on the longest connected run left out.
std::vector<int32_t> sides_off_the_longest_run(const Surface& s, const Chart& a, const Chart& b) {
  std::vector<int32_t> shared;
  for (int f : a.faces) {
    for (int k = 0; k < 3; ++k) {
      const int h = s.opposite[f][k];
      if (h >= 0 && std::binary_search(b.faces.begin(), b.faces.end(), h / 3)) {
        shared.push_back(3 * f + k);
      }
    }
  }
  const std::vector<std::vector<int32_t>> runs = connected_runs(s, shared);
  std::vector<int32_t> open;
  for (size_t run = 1; run < runs.size(); ++run) {
    for (const int side : runs[run]) {
      open.push_back(side);
      open.push_back(s.opposite[side / 3][side % 3]);
    }
  }
  return open;
}

}  // namespace

std::optional<Chart> Evaluator::partly_welded(const Chart& a, const Chart& b) const {
  Chart whole;
  whole.cuts = sides_off_the_longest_run(surface_, a, b);
  if (whole.cuts.empty() && a.cuts.empty() && b.cuts.empty()) return std::nullopt;
  whole.cuts.insert(whole.cuts.end(), a.cuts.begin(), a.cuts.end());
  whole.cuts.insert(whole.cuts.end(), b.cuts.begin(), b.cuts.end());
  std::merge(a.faces.begin(), a.faces.end(), b.faces.begin(), b.faces.end(),
             std::back_inserter(whole.faces));
  CutSides cuts(3 * surface_.faces.size(), 0);
  for (int h : whole.cuts) cuts[h] = 1;
  Piece piece = extract_piece(surface_, whole.faces, weight_, cuts);
  if (piece.component_count != 1 || piece.loops.empty() || piece.genus() != 0) return std::nullopt;
  ConformalScale scale = predict_scale(piece, context_);
  if (scale.area_distortion > limit() || context_.stopping()) return std::nullopt;
  FlattenOptions quick = options_.flatten;
  quick.quick = true;
  const Flattening flat = flatten({std::move(piece), std::move(scale)}, quick, context_);
  if (!flat.within) return std::nullopt;
  whole.area_distortion = flat.distortion.area;
  whole.angular = flat.distortion.angular;
  return whole;
}

}  // namespace partuv
