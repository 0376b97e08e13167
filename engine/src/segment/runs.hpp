#pragma once

#include <cstdint>
#include <vector>

#include "partuv/surface.hpp"

namespace partuv {

/// Sides (half-edges) joined at common vertices, the longest run first. Sides keep their order.
std::vector<std::vector<int32_t>> connected_runs(const Surface& surface,
                                                 const std::vector<int32_t>& sides);

}  // namespace partuv
