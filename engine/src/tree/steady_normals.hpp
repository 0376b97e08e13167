#pragma once

#include <vector>

#include "partuv/surface.hpp"

namespace partuv {

/// Unit normals; a face too thin to have one that rounding would leave alone borrows a neighbour's,
/// so that a crease does not vanish between two slivers. Zero where a whole component is that thin.
std::vector<Vec3> steady_normals(const Surface& surface);

}  // namespace partuv
