// Slivers that no neighbour can take in take faces over from one instead.
#include <algorithm>

#include "segment/evaluator.hpp"
#include "segment/grafter.hpp"
#include "segment/thin.hpp"

namespace partuv {
namespace {

bool serves(const Flattening& flat, double least_width) {
  return flat.within && flat.piece.component_count == 1 && narrow_width(flat) >= least_width;
}

}  // namespace

bool Grafter::widen(int sliver, double least_width) {
  constexpr size_t most_sides = 8;
  if (narrow_width(charts_[sliver].flattening) >= least_width) return false;
  const std::vector<Weld> welds = full_welds(sliver);
  std::vector<Weld> sides;
  for (const Weld& weld : welds) {
    for (const int side : weld.sides) sides.push_back(weld_along(weld.host, {side}));
  }
  sort_by_length(sides);
  if (sides.size() > most_sides) sides.resize(most_sides);
  // The bounds are means over faces: what is steep goes down better with more that is flat.
  const double enough_area = 16.0 * least_width * least_width;
  for (const Weld& side : sides) {
    const Weld& whole = *std::find_if(welds.begin(), welds.end(),
                                      [&](const Weld& weld) { return weld.host == side.host; });
    const std::vector<int32_t> near = faces_beyond(side.sides.front(), enough_area);
    const size_t most = std::min(near.size(), faces_of(side.host).size() / 2);
    for (size_t count = 1; count <= most; count += (count + 1) / 2) {
      const std::vector<int32_t> taken(near.begin(), near.begin() + count);
      if (take_over(side, sliver, taken, least_width)) return true;
      if (whole.sides.size() > 1 && take_over(whole, sliver, taken, least_width)) return true;
    }
  }
  return false;
}

std::vector<int32_t> Grafter::faces_beyond(int side, double enough_area) {
  constexpr size_t least_faces = 64, most_faces = 1024;
  std::unique_ptr<Marks> marks = borrow_marks();
  std::vector<int32_t> found;
  double area = 0.0;
  const auto find = [&](int f) {
    if (marks->seen[f]) return;
    marks->seen[f] = 1;
    found.push_back(f);
    area += 0.5 * face_cross(surface_, f).norm();
  };
  const auto enough = [&] {
    return found.size() >= most_faces || (found.size() >= least_faces && area >= enough_area);
  };
  find(surface_.opposite[side / 3][side % 3] / 3);
  const int host = chart_of_[found.front()];
  for (size_t i = 0; i < found.size() && !enough(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const int h = surface_.opposite[found[i]][k];
      if (h >= 0 && chart_of_[h / 3] == host && !cuts_[3 * found[i] + k]) find(h / 3);
    }
  }
  for (const int f : found) marks->seen[f] = 0;
  return_marks(std::move(marks));
  return found;
}

bool Grafter::take_over(const Weld& weld, int sliver, std::vector<int32_t> taken,
                        double least_width) {
  std::sort(taken.begin(), taken.end());
  std::optional<Flattening> wide = widened(weld, sliver, taken, least_width);
  if (!wide) return false;
  // Only now: to look at all of the host costs more than to flatten the few faces.
  const size_t asked = taken.size();
  const std::vector<int32_t> left = left_in_one_piece(weld.host, taken);
  if (taken.size() > asked) {
    wide = widened(weld, sliver, taken, least_width);
    if (!wide) return false;
  }
  work_faces_ += static_cast<double>(left.size());
  Flattening rest = restricted(charts_[weld.host].flattening, left, options_.flatten);
  if (!serves(rest, least_width)) return false;
  const double gained = angular_sum(*wide) + angular_sum(rest) -
                        angular_sum(charts_[weld.host].flattening) -
                        angular_sum(charts_[sliver].flattening);
  if (gained < std::min(0.0, -spare_angular_)) return false;
  spare_angular_ += gained;
  charts_[weld.host].flattening = std::move(rest);
  charts_[sliver].flattening = std::move(*wide);
  for (const int c : {static_cast<int>(weld.host), sliver}) {
    area_[c] = surface_area(charts_[c].flattening.piece.surface);
    take_in(c);
  }
  // Only when both are known: sides between them are none inside a chart.
  for (const int c : {static_cast<int>(weld.host), sliver}) note_cuts(charts_[c].flattening.piece);
  return true;
}

std::optional<Flattening> Grafter::widened(const Weld& weld, int sliver,
                                           const std::vector<int32_t>& taken, double least_width) {
  std::vector<int32_t> faces;
  std::merge(faces_of(sliver).begin(), faces_of(sliver).end(), taken.begin(), taken.end(),
             std::back_inserter(faces));
  work_faces_ += static_cast<double>(faces.size());
  const std::vector<int32_t> open = sides_off(weld, sliver);
  for (const int h : open) cuts_[h] = 1;
  Piece piece = extract_piece(surface_, faces, {}, cuts_);
  for (const int h : open) cuts_[h] = 0;
  if (piece.loops.empty()) return std::nullopt;
  ConformalScale scale = predict_scale(piece, context_);
  Flattening wide = flatten({std::move(piece), std::move(scale)}, options_.flatten, context_);
  if (!serves(wide, least_width) || !survives_rounding(wide, options_)) return std::nullopt;
  return wide;
}

std::vector<int32_t> Grafter::left_in_one_piece(int host, std::vector<int32_t>& taken) const {
  const Piece& piece = charts_[host].flattening.piece;
  std::vector<char> gone(piece.source_face.size(), 0);
  for (const int f : taken) gone[local_of_[f]] = 1;
  std::vector<int32_t> left;
  for (size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i]) left.push_back(static_cast<int32_t>(i));
  }
  std::vector<std::vector<int32_t>> parts = connected_parts(piece.surface, left);
  const auto largest = std::max_element(
      parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    if (part == largest) continue;
    for (const int i : *part) taken.push_back(piece.source_face[i]);
  }
  std::sort(taken.begin(), taken.end());
  return parts.empty() ? left : *largest;
}

}  // namespace partuv
