#include "segment/box_labels.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

namespace partuv {
namespace {

// Relative difference that counts as none: what is alike by symmetry must not be told apart by
// rounding.
constexpr double alike = 1e-4;

using Axes = Eigen::Matrix3d;  // in columns

/// Sum over the faces of area (p - mean)(p - mean)^T.
Eigen::Matrix3d area_spread(const Surface& s, const std::vector<int32_t>& faces) {
  Vec3 mean = Vec3::Zero();
  double area = 0.0;
  for (const int f : faces) {
    const double a = face_cross(s, f).norm();
    const Triangle& t = s.faces[f];
    mean += a * (s.positions[t[0]] + s.positions[t[1]] + s.positions[t[2]]) / 3.0;
    area += a;
  }
  if (area > 0.0) mean /= area;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const int f : faces) {
    const double a = face_cross(s, f).norm();
    for (const int v : s.faces[f]) {
      const Vec3 d = s.positions[v] - mean;
      spread += a * d * d.transpose();
    }
  }
  return spread;
}

/// The first direction that a face looks in, as seen along `axis`, if that is not from its side.
Vec3 first_look_across(const std::vector<Vec3>& normals, const std::vector<int32_t>& faces,
                       const Vec3& axis) {
  for (const int f : faces) {
    const Vec3 across = normals[f] - axis * axis.dot(normals[f]);
    if (across.norm() > 0.5) return across.normalized();
  }
  return axis.unitOrthogonal();
}

Vec3 first_normal(const std::vector<Vec3>& normals, const std::vector<int32_t>& faces) {
  for (const int f : faces) {
    if (!normals[f].isZero(0.0)) return normals[f];
  }
  return Vec3::UnitX();
}

/// The direction of an axis such that the first face that looks along it looks forward.
Vec3 forward(const std::vector<Vec3>& normals, const std::vector<int32_t>& faces,
             const Vec3& axis) {
  for (const int f : faces) {
    const double along = axis.dot(normals[f]);
    if (std::abs(along) > 0.5) return along > 0.0 ? axis : Vec3(-axis);
  }
  return axis;
}

/// Principal axes. Those of equal spread are free to turn: the first faces settle where to.
Axes box_axes(const Surface& s, const std::vector<Vec3>& normals,
              const std::vector<int32_t>& faces) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(area_spread(s, faces));
  Axes axes = solver.eigenvectors();
  const Vec3 spread = solver.eigenvalues();
  const bool low_alike = spread[1] - spread[0] <= alike * spread[2];
  const bool high_alike = spread[2] - spread[1] <= alike * spread[2];
  if (low_alike || high_alike) {
    if (low_alike && high_alike) {
      axes.col(0) = first_normal(normals, faces);
    } else if (low_alike) {
      axes.col(0) = Vec3(axes.col(2));
    }
    axes.col(1) = first_look_across(normals, faces, axes.col(0));
    axes.col(2) = axes.col(0).cross(axes.col(1));
  }
  for (int k = 0; k < 3; ++k) axes.col(k) = forward(normals, faces, axes.col(k));
  return axes;
}

}  // namespace

std::array<std::vector<int32_t>, 6> box_labels(const Surface& surface,
                                               const std::vector<Vec3>& normals,
                                               const std::vector<int32_t>& faces) {
  const Axes axes = box_axes(surface, normals, faces);
  std::array<std::vector<int32_t>, 6> by_label;
  for (const int f : faces) {
    const Vec3 n = axes.transpose() * normals[f];
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (std::abs(n[k]) > (1.0 + alike) * std::abs(n[axis])) axis = k;
    }
    by_label[2 * axis + (n[axis] < 0.0)].push_back(f);
  }
  return by_label;
}

}  // namespace partuv
