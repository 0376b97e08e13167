// Slivers that no neighbour can take in take faces over from one instead.
#include <algorithm>

#include "segment/grafter.hpp"

namespace partuv {

bool Grafter::widen(int sliver, double least_width) {
  constexpr size_t most_sides = 8, most_faces = 64;
  std::vector<Weld> sides;
  for (const Weld& weld : full_welds(sliver)) {
    for (const int side : weld.sides) sides.push_back(weld_along(weld.host, {side}));
  }
  sort_by_length(sides);
  if (sides.size() > most_sides) sides.resize(most_sides);
  for (const Weld& side : sides) {
    const std::vector<int32_t> near = faces_beyond(side, most_faces);
    const size_t most = std::min(near.size(), faces_of(side.host).size() / 2);
    for (size_t count = 1; count <= most; count += (count + 1) / 2) {
      if (take_over(side, sliver, {near.begin(), near.begin() + count}, least_width)) return true;
    }
  }
  return false;
}

std::vector<int32_t> Grafter::faces_beyond(const Weld& side, size_t most) const {
  const int across = side.sides.front();
  std::vector<int32_t> found{surface_.opposite[across / 3][across % 3] / 3};
  for (size_t i = 0; i < found.size() && found.size() < most; ++i) {
    for (int k = 0; k < 3 && found.size() < most; ++k) {
      const int h = surface_.opposite[found[i]][k];
      if (h < 0 || chart_of_[h / 3] != side.host || cuts_[3 * found[i] + k]) continue;
      if (std::find(found.begin(), found.end(), h / 3) == found.end()) found.push_back(h / 3);
    }
  }
  return found;
}

bool Grafter::take_over(const Weld& side, int sliver, std::vector<int32_t> taken,
                        double least_width) {
  std::sort(taken.begin(), taken.end());
  const auto serves = [&](const Flattening& flat) {
    return flat.within && flat.piece.component_count == 1 && mean_width(flat) >= least_width;
  };
  std::vector<int32_t> faces;
  std::merge(faces_of(sliver).begin(), faces_of(sliver).end(), taken.begin(), taken.end(),
             std::back_inserter(faces));
  work_faces_ += static_cast<double>(faces.size());
  const std::vector<int32_t> open = sides_off(side, sliver);
  for (const int h : open) cuts_[h] = 1;
  Piece piece = extract_piece(surface_, faces, {}, cuts_);
  for (const int h : open) cuts_[h] = 0;
  if (piece.loops.empty()) return false;
  ConformalScale scale = predict_scale(piece, context_);
  Flattening wide = flatten({std::move(piece), std::move(scale)}, options_.flatten, context_);
  if (!serves(wide)) return false;

  std::vector<int32_t> left;
  for (const int f : faces_of(side.host)) {
    if (!std::binary_search(taken.begin(), taken.end(), f)) left.push_back(local_of_[f]);
  }
  work_faces_ += static_cast<double>(left.size());
  Flattening rest = restricted(charts_[side.host].flattening, left, options_.flatten);
  if (!serves(rest)) return false;
  const double gained = angular_sum(wide) + angular_sum(rest) -
                        angular_sum(charts_[side.host].flattening) -
                        angular_sum(charts_[sliver].flattening);
  if (gained < std::min(0.0, -spare_angular_)) return false;
  spare_angular_ += gained;
  charts_[side.host].flattening = std::move(rest);
  charts_[sliver].flattening = std::move(wide);
  for (const int c : {static_cast<int>(side.host), sliver}) {
    area_[c] = surface_area(charts_[c].flattening.piece.surface);
    take_in(c);
  }
  // Only when both are known: sides between them are none inside a chart.
  for (const int c : {static_cast<int>(side.host), sliver}) note_cuts(charts_[c].flattening.piece);
  return true;
}

}  // namespace partuv
