#pragma once

#include "partuv/topology.hpp"

namespace partuv::detail {

/// Turn and move the surface of a numbered topology into a frame that its own faces define, and
/// round its positions there: what a rotation left in their last digits is gone. The positions as
/// they were, in that frame, go into `unrounded`.
void place_canonically(Topology& topology);

}  // namespace partuv::detail
