#pragma once

#include <cstdint>
#include <vector>

#include "pack/layout.hpp"
#include "pack/tile.hpp"
#include "partuv/context.hpp"
#include "partuv/pack.hpp"

namespace partuv::packing {

/// Fill one tile with the charts of every part together; `part` is that of each chart. Near gives
/// up the largest parts until it costs at most 5 % of the area that the charts get without it.
/// A context that stops early may leave the charts apart.
Layout fill_grouped(const std::vector<Outline>& charts, const std::vector<int32_t>& part,
                    const Bin& bin, const TilePlan& plan, Grouping grouping,
                    const Context& context);

}  // namespace partuv::packing
