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
  std::vector<int32_t> row_start;   ///< height + 1 offsets into `runs`
  std::vector<Run> runs;            ///< ascending and apart within a row
  std::vector<int32_t> test_order;  ///< rows in the order that finds a collision soonest
  double rotation_rad = 0.0;
  Vec2 centre = Vec2::Zero();  ///< the outline's centre, in cells from the mask's lower left corner
};

/// Which cells a mask takes.
enum class Cover {
  touched,  ///< all that the grown outline touches: masks that share no cell are truly apart
  centres,  ///< those whose centre it holds: true on average, off by up to a cell's diagonal
};

/// The outline turned, scaled (cells per outline unit) and grown by `growth` cells on every side.
/// O(sides * (1 + length in cells + growth)).
Mask make_mask(const Loops& loops, double rotation_rad, double scale, double growth, Cover cover);

/// A mask on the cells of a board, with the cell of its lower left corner.
struct PlacedMask {
  Mask mask;
  int x = 0;
  int y = 0;
};

/// The same for an outline whose centre lies anywhere on the board, given in cells.
PlacedMask make_placed_mask(const Loops& loops, double rotation_rad, const Vec2& centre,
                            double scale, double growth, Cover cover);

}  // namespace partuv::packing
