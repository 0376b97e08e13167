#include "segment/lift_regions.hpp"

#include <Eigen/Geometry>
#include <map>
#include <utility>

namespace partuv::detail {

/// True if all the other faces around that corner of f have the label and close up to a disk.
bool Regions::surrounded(int f, int corner, int32_t label) const {
  int h = 3 * f + corner;
  do {
    h = surface_.opposite[h / 3][(h % 3 + 2) % 3];
    if (h < 0) return false;
    if (h / 3 != f && label_[h / 3] != label) return false;
  } while (h != 3 * f + corner);
  return true;
}

/// True if a region with this label keeps its topology when f joins or leaves it: f hangs on it by
/// one side, or by two with the corner between them inside the region.
bool Regions::simple_for(int f, int32_t label) const {
  int sides = 0, other = -1;
  for (int s = 0; s < 3; ++s) {
    if (has_label(f, s, label)) {
      ++sides;
    } else {
      other = s;
    }
  }
  if (sides == 1) return true;
  return sides == 2 && surrounded(f, (other + 2) % 3, label);
}

bool Regions::can_change(int f, int32_t label) const {
  return simple_for(f, label_[f]) && simple_for(f, label);
}

void Regions::change_to(const std::vector<int32_t>& wanted, const std::vector<int32_t>& faces) {
  std::vector<int32_t> queue = faces;
  for (size_t i = 0; i < queue.size(); ++i) {
    const int f = queue[i];
    if (wanted[f] == label_[f] || !can_change(f, wanted[f])) continue;
    label_[f] = wanted[f];
    // The change may make those around simple.
    for (int corner = 0; corner < 3; ++corner) {
      const int start = 3 * f + corner;
      int h = start;
      do {
        h = surface_.opposite[h / 3][(h % 3 + 2) % 3];
        if (h >= 0 && wanted[h / 3] != label_[h / 3]) queue.push_back(h / 3);
      } while (h >= 0 && h != start);
    }
  }
}

void Regions::keep_largest_pieces(int labels) {
  const int faces = surface_.face_count();
  std::vector<int32_t> piece(faces, -1), first_of_piece;
  std::vector<double> piece_area;
  std::vector<int32_t> stack;
  for (int seed = 0; seed < faces; ++seed) {
    if (piece[seed] >= 0) continue;
    const int id = static_cast<int>(piece_area.size());
    double area = 0.0;
    piece[seed] = id;
    stack.push_back(seed);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      area += face_cross(surface_, f).norm();
      for (int s = 0; s < 3; ++s) {
        if (!has_label(f, s, label_[seed])) continue;
        const int g = across(f, s) / 3;
        if (piece[g] >= 0) continue;
        piece[g] = id;
        stack.push_back(g);
      }
    }
    piece_area.push_back(area);
    first_of_piece.push_back(seed);
  }
  const int pieces = static_cast<int>(piece_area.size());
  std::vector<int32_t> largest(labels, -1);
  for (int p = 0; p < pieces; ++p) {
    int32_t& kept = largest[label_[first_of_piece[p]]];
    if (kept < 0 || piece_area[p] > piece_area[kept]) kept = p;
  }
  std::vector<uint8_t> settled(pieces, 0);
  int stray = 0;
  for (int p = 0; p < pieces; ++p) {
    settled[p] = largest[label_[first_of_piece[p]]] == p;
    stray += !settled[p];
  }
  // A stray piece may have stray neighbours only: then it waits for them. Pieces of a component in
  // which nothing is settled stay as they are.
  for (bool progress = true; stray > 0 && progress;) {
    progress = false;
    std::vector<std::map<int32_t, double>> shared(pieces);
    for (int f = 0; f < faces; ++f) {
      if (settled[piece[f]]) continue;
      for (int s = 0; s < 3; ++s) {
        const int h = across(f, s);
        if (h < 0 || !settled[piece[h / 3]]) continue;
        const Triangle& t = surface_.faces[f];
        shared[piece[f]][label_[h / 3]] +=
            (surface_.positions[t[(s + 1) % 3]] - surface_.positions[t[s]]).norm();
      }
    }
    std::vector<int32_t> adopted(pieces, -1);
    for (int p = 0; p < pieces; ++p) {
      double longest = -1.0;
      for (const auto& [label, length] : shared[p]) {
        if (length > longest) {
          longest = length;
          adopted[p] = label;
        }
      }
    }
    for (int f = 0; f < faces; ++f) {
      if (adopted[piece[f]] >= 0) label_[f] = adopted[piece[f]];
    }
    for (int p = 0; p < pieces; ++p) {
      if (adopted[p] < 0) continue;
      settled[p] = 1;
      --stray;
      progress = true;
    }
  }
}

}  // namespace partuv::detail
