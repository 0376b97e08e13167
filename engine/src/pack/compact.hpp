#pragma once

#include <cstdint>
#include <vector>

#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// What came of pushing charts apart, or of tightening them.
struct Pushed {
  std::vector<int> caught;  ///< charts that could not be freed, none after success
  int64_t work = 0;         ///< about that many thirds of a nanosecond
};

/// Grow the common scale of a layout by shifting and turning all charts at once, until they hold
/// each other fast: linear programs over the distances between outlines, within a trust region that
/// shrinks where the linear picture fails (after Li and Milenkovic, Eur. J. Oper. Res. 84, 1995,
/// with turns and scale added). Keeps `gutter` between the given loops; the layout must hold it, or
/// miss it by little, in which case the scale may also fall. Upright charts do not turn. `steps`
/// bounds the programs solved, `trust` how far charts may move in the first one, in texels. Returns
/// the work.
int64_t compact(const std::vector<Loops>& loops, const Bin& bin, bool upright, int steps,
                double trust, Layout& layout, const Context& context);

/// The motion of one such program, scale and all, without a look at what came of it: over short
/// ways the gutter is missed by the square of them at most. Returns false, and leaves the layout,
/// where the program was not solved.
bool nudge(const std::vector<Loops>& loops, const Bin& bin, double trust, Layout& layout,
           const Context& context);

/// Push charts of a layout apart at its scale until the loops keep the gutter and the bin, by the
/// same programs. The outlines may be too near each other but must not cross. Of each pair that
/// could not be freed the smaller chart counts as caught.
Pushed push_apart(const std::vector<Loops>& loops, const Bin& bin, bool upright, int steps,
                  double trust, Layout& layout, const Context& context);

}  // namespace partuv::packing
