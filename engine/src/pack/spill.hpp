#pragma once

#include <cstdint>
#include <vector>

#include "pack/layout.hpp"
#include "pack/tile.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

struct Spill {
  Layout layout;              ///< each chart in its own tile
  std::vector<int32_t> tile;  ///< of each chart
  bool fits = false;          ///< whether every chart fits a tile, and `most_tiles` hold them all
};

/// Place charts at a given scale (texels per outline unit), each in the first tile that has room
/// for it, largest first. Not stopped by a deadline, as there is no faster way to a valid result.
Spill spill(const std::vector<Outline>& charts, const Bin& bin, const TilePlan& plan, double scale,
            const Context& context);

}  // namespace partuv::packing
