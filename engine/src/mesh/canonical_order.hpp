#pragma once

#include "partuv/topology.hpp"

namespace partuv::detail {

/// Give a topology the canonical numbering, corners of faces included.
void number_canonically(Topology& topology);

}  // namespace partuv::detail
