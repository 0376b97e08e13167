#pragma once

#include <cstdint>
#include <vector>

#include "pack/mask.hpp"

namespace partuv::packing {

/// A grid of cells, free or taken, that finds room for masks with words of 64 cells at a time.
///
/// Beside every row it keeps, for each power of two p, the row of "some cell of [x, x + p) is
/// taken": a run of any length then collides at x where either of two words-wide shifts says so.
class Board {
 public:
  /// `side` rows of `width` cells.
  Board(int side, int width);
  explicit Board(int side) : Board(side, side) {}

  struct Spot {
    int x = 0;
    int y = 0;
    bool found = false;
  };

  /// The lowest row, and in it the leftmost column, where the mask's lower left corner may lie,
  /// with row in [from, to). O((to - from) * runs * side / 64), most rows are refused much sooner.
  Spot lowest(const Mask& mask, int from, int to);

  /// Take a mask's cells; what lies outside the board is left out.
  void put(const Mask& mask, int x, int y);
  void clear();
  int side() const { return side_; }
  int filled_height() const { return filled_height_; }  ///< rows from here on are free

 private:
  int side_, width_;
  int words_;                          // per row, with a word of taken cells behind the right edge
  int levels_;                         // powers of two up to the width
  std::vector<uint64_t> taken_;        // [row][level][word]
  std::vector<int32_t> longest_free_;  // per row
  std::vector<uint64_t> collision_;    // scratch of `lowest`
  int filled_height_ = 0;

  uint64_t* level(int row, int k) { return &taken_[(size_t(row) * levels_ + k) * words_]; }
  void refresh(int row);
};

}  // namespace partuv::packing
