#include "mesh/denoise_normals.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "mesh/parallel_chunks.hpp"

namespace partuv::detail {

std::vector<Vec3> filtered_normals(const Surface& surface, double noise, const Context& context) {
  constexpr int passes = 4;
  constexpr double least_deviation = 0.35, deviation_per_noise = 4.0;
  const double deviation = least_deviation + deviation_per_noise * noise;
  const double falloff = 0.5 / (deviation * deviation);
  const int faces = surface.face_count();
  std::vector<Vec3> normal(faces), next(faces);
  std::vector<double> area(faces);
  parallel_chunks(context, faces, [&](int f) {
    const Vec3 cross = face_cross(surface, f);
    normal[f] = cross.stableNormalized();
    area[f] = cross.norm();
  });
  for (int pass = 0; pass < passes; ++pass) {
    parallel_chunks(context, faces, [&](int f) {
      Vec3 sum = area[f] * normal[f];
      for (const int h : surface.opposite[f]) {
        if (h < 0) continue;
        const int g = h / 3;
        sum += area[g] * std::exp(-falloff * (normal[g] - normal[f]).squaredNorm()) * normal[g];
      }
      next[f] = sum.stableNormalized();
    });
    normal.swap(next);
  }
  return normal;
}

double crease_angle(double noise) { return 0.6 + 2.0 * noise; }

}  // namespace partuv::detail
