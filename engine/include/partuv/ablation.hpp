#pragma once

namespace partuv {

/// Steps of an unwrap that may be left out, or added, to see what they are worth. For measurements:
/// whatever is left out, the atlas keeps its bounds, with more charts or in more time.
struct Ablation {
  bool proxy = true;            ///< search on a coarse stand-in of a large surface
  bool merge_heuristic = true;  ///< try Merge where Normal succeeded
  bool recursion = false;       ///< search below accepted nodes at every quality, as the paper does
  bool final_merge = true;      ///< merge charts across parts afterwards
  bool cut_open = true;         ///< open closed and tubular pieces
  bool polish = true;           ///< trade a little angle for area after the conformal map
  int fixed_parts = 0;          ///< cut the tree into that many parts before the search; 0: don't
};

}  // namespace partuv
