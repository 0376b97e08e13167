#pragma once

#include <cstdint>
#include <vector>

#include "partuv/surface.hpp"

namespace partuv::detail {

/// Labelled regions of a surface. A region is joined across sides only: faces that share nothing
/// but a vertex are not neighbours.
class Regions {
 public:
  Regions(const Surface& surface, std::vector<int32_t>& label) : surface_(surface), label_(label) {}

  /// True if giving face f to `label`, the label of one of its neighbours, changes the topology of
  /// neither region: no part, hole or neck comes or goes.
  bool can_change(int f, int32_t label) const;

  /// Give every face the label it wants, one simple change at a time; a face whose change never
  /// gets simple keeps its label.
  void change_to(const std::vector<int32_t>& wanted, const std::vector<int32_t>& faces);

  /// Change single faces where that makes the boundary cheaper and is simple, until none is left.
  /// `gain(f, label)` is what is saved.
  template <typename Gain>
  void descend(std::vector<int32_t> faces, Gain&& gain);

  /// Leave each label its largest connected piece and give the others to the label they share the
  /// longest boundary with.
  void keep_largest_pieces(int labels);

 private:
  int across(int f, int side) const { return surface_.opposite[f][side]; }
  bool has_label(int f, int side, int32_t label) const {
    const int h = across(f, side);
    return h >= 0 && label_[h / 3] == label;
  }
  bool surrounded(int f, int corner, int32_t label) const;
  bool simple_for(int f, int32_t label) const;

  const Surface& surface_;
  std::vector<int32_t>& label_;
};

template <typename Gain>
void Regions::descend(std::vector<int32_t> faces, Gain&& gain) {
  for (size_t i = 0; i < faces.size(); ++i) {
    const int f = faces[i];
    for (int s = 0; s < 3; ++s) {
      const int h = across(f, s);
      if (h < 0 || label_[h / 3] == label_[f]) continue;
      const int32_t other = label_[h / 3];
      if (!(gain(f, other) > 0.0) || !can_change(f, other)) continue;
      label_[f] = other;
      for (int side = 0; side < 3; ++side) {
        if (across(f, side) >= 0) faces.push_back(across(f, side) / 3);
      }
      break;
    }
  }
}

}  // namespace partuv::detail
