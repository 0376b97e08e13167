#pragma once

#include <vector>

#include "pack/frame.hpp"
#include "pack/layout.hpp"
#include "pack/written.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// Grow a layout that holds `frame` until its gutters are used up, and with them what the frame
/// leaves for rounding beyond what rounding takes: charts close up on their exact outlines, and as
/// written they have to hold `asked`. The layout stays where nothing better is found.
void finish(const std::vector<Outline>& charts, const Frame& frame, const Frame& asked,
            const WrittenGrid& grid, Layout& layout, const Context& context);

}  // namespace partuv::packing
