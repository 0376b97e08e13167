#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace partuv {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Triangle = std::array<int32_t, 3>;

/// The caller's mesh. Input order is kept for ever: every output array is per input face or corner.
struct Mesh {
  std::vector<Vec3> positions;  ///< V points, any unit
  std::vector<Triangle> faces;  ///< F x 3 indices into `positions`
};

}  // namespace partuv
