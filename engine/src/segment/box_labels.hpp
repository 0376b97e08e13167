#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "partuv/surface.hpp"

namespace partuv {

/// Faces by the side of a box that they look at most (the paper's Merge heuristic): ascending, on
/// the positive and the negative side of each axis. The box lies along the principal axes of the
/// area; how the surface lies in space does not matter. normals: of all faces of the surface.
std::array<std::vector<int32_t>, 6> box_labels(const Surface& surface,
                                               const std::vector<Vec3>& normals,
                                               const std::vector<int32_t>& faces);

}  // namespace partuv
