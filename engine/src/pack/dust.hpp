#pragma once

#include <vector>

#include "pack/layout.hpp"
#include "pack/tile.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// A tile of more charts than are searched, where a few hold most of the area: those are packed by
/// themselves, with search, and the others go into the room that is left, at the largest scale
/// found. Scale 0 where that is no larger than `least_scale`.
Layout fill_around_large(const std::vector<Outline>& charts, const Bin& bin, const TilePlan& plan,
                         double least_scale, const Context& context);

}  // namespace partuv::packing
