#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/surface.hpp"

namespace partuv::detail {

/// Move every source face from its first proxy face to the nearest one that can be reached from it
/// over the proxy's surface with falling distance, then make each proxy face's set connected.
/// `length` is the unit in which a turned normal counts as distance.
void settle_provenance(const Surface& source, const Surface& proxy, double length,
                       std::vector<int32_t>& proxy_of_face, const Context& context);

}  // namespace partuv::detail
