#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "mesh/denoise_normals.hpp"
#include "mesh/parallel_chunks.hpp"
#include "partuv/lift.hpp"

namespace partuv {

SideWeights weigh_sides(const Surface& surface, double noise, const Context& context) {
  // The share of its length that a steep edge saves a boundary.
  constexpr double concave_saving = 0.8, convex_saving = 0.5;
  const double crease_angle = detail::crease_angle(noise);
  const std::vector<Vec3> normal = detail::filtered_normals(surface, noise, context);
  SideWeights sides;
  sides.cost.resize(surface.faces.size());
  sides.crease.resize(surface.faces.size());
  detail::parallel_chunks(context, surface.face_count(), [&](int f) {
    for (int s = 0; s < 3; ++s) {
      const Triangle& t = surface.faces[f];
      const Vec3 edge = surface.positions[t[(s + 1) % 3]] - surface.positions[t[s]];
      const int h = surface.opposite[f][s];
      double saving = 0.0;
      sides.crease[f][s] = 0;
      if (h >= 0) {
        const Vec3& a = normal[f];
        const Vec3& b = normal[h / 3];
        const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
        const double steepness = std::min(1.0, angle / crease_angle);
        const bool convex = a.cross(b).dot(edge) > 0.0;
        saving = steepness * steepness * (convex ? convex_saving : concave_saving);
        sides.crease[f][s] = angle >= crease_angle;
      }
      sides.cost[f][s] = static_cast<float>((1.0 - saving) * edge.norm());
    }
  });
  return sides;
}

}  // namespace partuv
