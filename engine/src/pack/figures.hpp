#pragma once

#include <vector>

#include "pack/layout.hpp"
#include "partuv/pack.hpp"

namespace partuv::packing {

/// What a filled tile came to. `inset` is the bin's distance from the tile's edge, `rounding` what
/// rounding may take from a distance; all in texels.
TileFigures measure_tile(const std::vector<Outline>& charts, const Layout& layout, double inset,
                         double rounding, int resolution);

}  // namespace partuv::packing
