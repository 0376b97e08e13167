#pragma once

#include <cstdint>
#include <vector>

#include "partuv/pack.hpp"

namespace partuv::packing {

/// A tile for every chart, `tiles` of them or one per part for 0. Parts are taken in the order of
/// their rank and cut into runs of about equal area; parts too large for that are taken chart by
/// chart. `area` is that of each chart. O(N log N).
std::vector<int32_t> assign_tiles(const std::vector<PackChart>& charts,
                                  const std::vector<double>& area, int tiles);

}  // namespace partuv::packing
