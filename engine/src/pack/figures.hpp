#pragma once

#include <vector>

#include "pack/frame.hpp"
#include "pack/layout.hpp"
#include "pack/written.hpp"
#include "partuv/pack.hpp"

namespace partuv::packing {

/// What a filled tile came to.
TileFigures measure_tile(const std::vector<Outline>& charts, const Layout& layout,
                         const Frame& frame, const PackOptions& options, const WrittenGrid& grid);

}  // namespace partuv::packing
