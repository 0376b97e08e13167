#pragma once

#include <cstdint>
#include <vector>

#include "pack/greedy.hpp"
#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

struct SeparationPlan {
  int cells = 256;     ///< along a side of the bin
  int rotations = 8;   ///< turns a chart may take besides the one it has
  bool askew = false;  ///< begin every chart's turns at an angle of its own
  int trials = 4;      ///< of these looked at per move
  uint64_t seed = 0;
  int64_t work = 0;  ///< words of sums it may add up before it gives up
  Cover cover = Cover::centres;
};

struct Separation {
  Layout layout;     ///< scale 0 when it gave up
  int64_t work = 0;  ///< done
};

/// Move charts of a layout, one at a time and anywhere in the bin, until none overlap on the grid:
/// guided local search (Egeblad, Nielsen, Odgaard 2007; Gardeyn, Wauters 2025), on a raster. A move
/// takes a chart to the turn and cell where the weighted area it shares with others is least, found
/// exactly over all cells; pairs that keep overlapping gain weight. The outcome may miss the gutter
/// by a cell's diagonal, as the cover says.
Separation separate(const std::vector<Shape>& shapes, const Bin& bin, const Layout& start,
                    const SeparationPlan& plan, const Context& context);

}  // namespace partuv::packing
