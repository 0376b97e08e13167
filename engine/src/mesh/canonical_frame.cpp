#include "mesh/canonical_frame.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "rounded.hpp"

namespace partuv::detail {
namespace {

/// In units of the root of the surface's area; far below what single precision holds.
constexpr double coarsest_step = 0x1p-30;

/// The largest face that leans away from an axis, by number among equals; -1 if there is none.
int largest_face(const Surface& surface, const Vec3& axis) {
  constexpr double leaning = 0.7;  // cosine: 45 degrees and more
  int largest = -1;
  float most = 0.0f;
  for (int f = 0; f < surface.face_count(); ++f) {
    const Vec3 cross = face_cross(surface, f);
    const double length = cross.norm();
    const float area = rounded(length);
    if (!(area > most) || std::abs(cross.dot(axis)) > leaning * length) continue;
    largest = f;
    most = area;
  }
  return largest;
}

Vec3 longest_side(const Surface& surface, int f) {
  Vec3 longest = Vec3::Zero();
  float most = 0.0f;
  for (int k = 0; k < 3; ++k) {
    const Triangle& t = surface.faces[f];
    const Vec3 side = surface.positions[t[(k + 1) % 3]] - surface.positions[t[k]];
    if (!(rounded(side.norm()) > most)) continue;
    longest = side;
    most = rounded(side.norm());
  }
  return longest;
}

/// Rows are the axes: the normal of the largest face, and that of the largest face that leans away
/// from it. So what is planar and upright on most parts lies on planes of the grid.
Eigen::Matrix3d frame_of(const Surface& surface) {
  const int first = largest_face(surface, Vec3::Zero());
  if (first < 0) return Eigen::Matrix3d::Identity();
  const Vec3 z = face_cross(surface, first).normalized();
  const int second = largest_face(surface, z);
  const Vec3 aside = second >= 0 ? face_cross(surface, second) : longest_side(surface, first);
  const Vec3 x = (aside - z * z.dot(aside)).normalized();
  Eigen::Matrix3d frame;
  frame << x.transpose(), z.cross(x).transpose(), z.transpose();
  return frame;
}

Vec3 centre_of_area(const Surface& surface) {
  Vec3 sum = Vec3::Zero();
  double area = 0.0;
  for (int f = 0; f < surface.face_count(); ++f) {
    const Triangle& t = surface.faces[f];
    const double share = face_cross(surface, f).norm();
    sum += share * (surface.positions[t[0]] + surface.positions[t[1]] + surface.positions[t[2]]);
    area += share;
  }
  return area > 0.0 ? Vec3(sum / (3.0 * area)) : Vec3::Zero();
}

/// Per vertex the step that it is rounded to: a hundredth of the height of the lowest face around
/// it at most, or rounding would change the face's shape. Faces of no height but what rotations
/// leave have no shape to keep; they stay too flat to be measured. A power of two.
std::vector<double> grid_steps(const Surface& surface) {
  constexpr double most_change = 0.01, no_height = 0x1p-47, step_of_flat = 0x1p-44;
  std::vector<double> step(surface.positions.size(), coarsest_step);
  for (int f = 0; f < surface.face_count(); ++f) {
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, side_length(surface, 3 * f + k));
    const double height = face_cross(surface, f).norm() / longest;
    const double allowed = height < no_height ? step_of_flat : most_change * height;
    if (!(allowed < coarsest_step)) continue;
    const double own = std::exp2(std::floor(std::log2(allowed)));
    for (const int v : surface.faces[f]) step[v] = std::min(step[v], own);
  }
  return step;
}

}  // namespace

void place_canonically(Topology& topology) {
  Surface& surface = topology.surface;
  const Vec3 centre = centre_of_area(surface);
  const Eigen::Matrix3d frame = frame_of(surface);
  for (Vec3& p : surface.positions) p = frame * (p - centre);
  topology.unrounded = surface.positions;
  const std::vector<double> step = grid_steps(surface);
  for (size_t v = 0; v < surface.positions.size(); ++v) {
    for (double& x : surface.positions[v]) x = std::round(x / step[v]) * step[v];
  }
}

}  // namespace partuv::detail
