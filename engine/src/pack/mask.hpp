#pragma once

#include <cstdint>
#include <vector>

#include "pack/layout.hpp"

namespace partuv::packing {

/// Cells [begin, end) of a row.
struct Run {
  int32_t begin;
  int32_t end;
};

/// A turned, scaled and grown outline on a grid of cells, as runs of cells row by row.
struct Mask {
  int width = 0;
  int height = 0;
  std::vector<int32_t> row_start;  ///< height + 1 offsets into `runs`
  std::vector<Run> runs;
  std::vector<int32_t> test_order;  ///< rows in the order that finds a collision soonest
  double rotation_rad = 0.0;
  Vec2 centre = Vec2::Zero();  ///< the outline's centre, in cells from the mask's lower left corner
  double filled = 0.0;         ///< number of cells
};

/// Cells touched by the outline grown by `growth` (a disk's radius) on every side. Scale and growth
/// are in cells. Two masks that share no cell belong to outlines at least 2 * growth apart.
/// O(segments * (1 + length in cells + growth)).
Mask make_mask(const Outline& outline, double rotation_rad, double scale, double growth);

}  // namespace partuv::packing
