#pragma once

#include <vector>

#include "partuv/types.hpp"

namespace partuv::packing {

/// A rotation of a convex hull and the size of its upright box then.
struct Orientation {
  double rotation_rad = 0.0;
  Vec2 size = Vec2::Zero();
};

/// Upright box of a hull turned by an angle.
Vec2 turned_size(const std::vector<Vec2>& hull, double rotation_rad);

/// The turn that makes the upright box smallest in area, its longer side along x.
Orientation least_rectangle(const std::vector<Vec2>& hull);

/// The turn that makes the longer side of the upright box smallest.
Orientation least_square(const std::vector<Vec2>& hull);

}  // namespace partuv::packing
