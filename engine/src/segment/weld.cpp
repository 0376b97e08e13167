#include <algorithm>

#include "disjoint_sets.hpp"
#include "segment/evaluator.hpp"

namespace partuv {
namespace {

/// Sides of `a` that face `b`, those on the longest connected run left out.
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
  // Runs: sides joined at common vertices.
  std::vector<std::pair<int32_t, int32_t>> ends;  // (vertex, index in `shared`)
  for (size_t i = 0; i < shared.size(); ++i) {
    const int f = shared[i] / 3, k = shared[i] % 3;
    ends.emplace_back(s.faces[f][k], static_cast<int32_t>(i));
    ends.emplace_back(s.faces[f][(k + 1) % 3], static_cast<int32_t>(i));
  }
  std::sort(ends.begin(), ends.end());
  DisjointSets runs(static_cast<int>(shared.size()));
  for (size_t i = 1; i < ends.size(); ++i) {
    if (ends[i].first != ends[i - 1].first) continue;
    runs.join(ends[i].second, ends[i - 1].second);
  }
  std::vector<double> length(shared.size(), 0.0);
  for (size_t i = 0; i < shared.size(); ++i) {
    const Triangle& t = s.faces[shared[i] / 3];
    const int k = shared[i] % 3;
    length[runs.find(static_cast<int>(i))] +=
        (s.positions[t[(k + 1) % 3]] - s.positions[t[k]]).norm();
  }
  const int longest =
      static_cast<int>(std::max_element(length.begin(), length.end()) - length.begin());
  std::vector<int32_t> open;
  for (size_t i = 0; i < shared.size(); ++i) {
    if (runs.find(static_cast<int>(i)) == longest) continue;
    open.push_back(shared[i]);
    open.push_back(s.opposite[shared[i] / 3][shared[i] % 3]);
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
