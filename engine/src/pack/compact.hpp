#pragma once

#include <vector>

#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// Grow the common scale of a layout by shifting and turning all charts at once, until they hold
/// each other fast: linear programs over the distances between outlines, within a trust region that
/// shrinks where the linear picture fails (after Li and Milenkovic, Eur. J. Oper. Res. 84, 1995,
/// with turns and scale added). Keeps `gutter` between the given loops; the layout must hold it, or
/// miss it by little, in which case the scale may also fall. Upright charts do not turn. `steps`
/// bounds the programs solved.
void compact(const std::vector<Loops>& loops, const Bin& bin, bool upright, int steps,
             Layout& layout, const Context& context);

/// Push charts of a layout apart at its scale until the loops keep the gutter and the bin, by the
/// same programs. The outlines may be too near each other but must not cross. Returns the charts
/// that could not be freed (of each pair the smaller), none after success.
std::vector<int> push_apart(const std::vector<Loops>& loops, const Bin& bin, bool upright,
                            int steps, Layout& layout, const Context& context);

}  // namespace partuv::packing
