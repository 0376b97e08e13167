#pragma once

#include <vector>

#include "partuv/flatten.hpp"

namespace partuv {

/// Split a flattening that lies on itself between two patches that cover the same ground, along the
/// shortest seam (minimum cut). True for the faces on one side; empty if no two separate patches
/// overlap.
std::vector<char> separate_overlap(const Flattening& flattening);

}  // namespace partuv
