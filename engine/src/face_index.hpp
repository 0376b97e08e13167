#pragma once

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "scramble.hpp"

namespace partuv {

/// Position of each face in a list, by open addressing: as large as the list, not as the surface.
class FaceIndex {
 public:
  explicit FaceIndex(const std::vector<int32_t>& faces)
      : slots_(std::bit_ceil(2 * faces.size() + 1), {-1, -1}) {
    for (size_t i = 0; i < faces.size(); ++i)
      slots_[slot(faces[i])] = {faces[i], static_cast<int32_t>(i)};
  }
  /// -1 where the face is not in the list.
  int find(int face) const { return slots_[slot(face)].second; }

 private:
  /// Where the face is or would be.
  size_t slot(int face) const {
    const size_t mask = slots_.size() - 1;
    size_t at = static_cast<size_t>(scramble(static_cast<uint64_t>(face))) & mask;
    while (slots_[at].first >= 0 && slots_[at].first != face) at = (at + 1) & mask;
    return at;
  }

  std::vector<std::pair<int32_t, int32_t>> slots_;  ///< (face, position)
};

}  // namespace partuv
