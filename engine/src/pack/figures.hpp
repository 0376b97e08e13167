#pragma once

#include <vector>

#include "pack/frame.hpp"
#include "pack/layout.hpp"
#include "partuv/pack.hpp"

namespace partuv::packing {

/// What a filled tile came to. `rounding` is what rounding may take from a distance, in texels.
TileFigures measure_tile(const std::vector<Outline>& charts, const Layout& layout,
                         const Frame& frame, double rounding, int resolution);

}  // namespace partuv::packing
