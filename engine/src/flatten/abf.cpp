// ABF++ (Sheffer, Levy, Mogilnitsky, Bogomyakov 2005) with the wheel constraint in log form
// (Zayer, Levy, Seidel 2007): Newton steps on the angles, triangle multipliers eliminated in closed
// form, which leaves a positive definite system of two unknowns per inner vertex.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "flatten/system.hpp"
#include "partuv/flatten.hpp"

namespace partuv {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat36 = Eigen::Matrix<double, 3, 6>;
constexpr double pi = std::numbers::pi;
constexpr double least_angle = pi / 180.0;
/// Angles below this weigh no more than it does, so that needles do not stiffen the system.
constexpr double least_weighted_angle = 3.0 * pi / 180.0;

std::vector<Vec3> corner_angles(const std::vector<RestTriangle>& rest) {
  std::vector<Vec3> angles(rest.size());
  for (size_t f = 0; f < rest.size(); ++f) {
    const RestTriangle& r = rest[f];
    const double a = std::atan2(r.y, r.x), b = std::atan2(r.y, r.length - r.x);
    angles[f] = Vec3(a, b, pi - a - b);
  }
  return angles;
}

/// Jacobian of a face's share of the constraints (sum, wheel per corner) over its three angles.
Mat36 constraint_jacobian(const Vec3& alpha) {
  Mat36 b = Mat36::Zero();
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    b(k, 2 * k) = 1.0;
    b(next, 2 * k + 1) = 1.0 / std::tan(alpha[next]);
    b(last, 2 * k + 1) = -1.0 / std::tan(alpha[last]);
  }
  return b;
}

}  // namespace

std::vector<RestTriangle> angle_based_shapes(const Piece& piece,
                                             const std::vector<RestTriangle>& rest, int steps,
                                             const Context& context) {
  const Surface& s = piece.surface;
  const int n = s.face_count();
  const std::vector<char> boundary = boundary_vertices(s);
  std::vector<int32_t> unknown(s.vertex_count(), -1);
  int inner = 0;
  for (int v = 0; v < s.vertex_count(); ++v) {
    if (!boundary[v]) unknown[v] = inner++;
  }
  if (inner == 0)
    return rest;  // no constraint but the triangles': the angles are right as they are

  const std::vector<Vec3> angles = corner_angles(rest);
  std::vector<double> sum(s.vertex_count(), 0.0);
  for (int f = 0; f < n; ++f) {
    for (int k = 0; k < 3; ++k) sum[s.faces[f][k]] += angles[f][k];
  }
  std::vector<Vec3> ideal(n), inverse_weight(n);
  std::vector<Triangle> faces = s.faces;
  for (int f = 0; f < n; ++f) {
    for (int k = 0; k < 3; ++k) {
      const int v = s.faces[f][k];
      ideal[f][k] = boundary[v] ? angles[f][k] : angles[f][k] * 2.0 * pi / sum[v];
      ideal[f][k] = std::clamp(ideal[f][k], least_angle, pi - 2.0 * least_angle);
      const double weighted = std::max(angles[f][k], least_weighted_angle);
      inverse_weight[f][k] = weighted * weighted;
      faces[f][k] = unknown[v];
    }
  }

  MeshSystem<2> system(faces, inner);
  std::vector<Vec3> alpha = ideal, best = ideal;
  double best_residual = std::numeric_limits<double>::infinity();
  Eigen::VectorXd residual(2 * inner);
  for (int iteration = 0;; ++iteration) {
    // Constraint values at alpha: vertex sums (2 pi) and wheels (log sines), triangle sums apart.
    residual.setZero();
    double triangle_residual = 0.0;
    for (int f = 0; f < n; ++f) {
      triangle_residual += std::pow(alpha[f].sum() - pi, 2);
      for (int k = 0; k < 3; ++k) {
        if (faces[f][k] < 0) continue;
        residual[2 * faces[f][k]] += alpha[f][k];
        residual[2 * faces[f][k] + 1] +=
            std::log(std::sin(alpha[f][(k + 1) % 3]) / std::sin(alpha[f][(k + 2) % 3]));
      }
    }
    for (int i = 0; i < inner; ++i) residual[2 * i] -= 2.0 * pi;
    const double norm = residual.squaredNorm() + triangle_residual;
    if (norm < best_residual) {
      best_residual = norm;
      best = alpha;
    }
    if (iteration == steps || norm < 1e-10 * n) break;

    // Reduced system: (B' P B) x = c + B'(ideal - alpha) - B' W t / w, W the inverse weights, w
    // their sum, P = W - W 1 1' W / w, t the triangle residual at the ideal angles.
    system.clear();
    Eigen::VectorXd rhs = residual;
    for (int f = 0; f < n; ++f) {
      const Mat36 b = constraint_jacobian(alpha[f]);
      const Vec3& w = inverse_weight[f];
      const double total = w.sum();
      const Mat36 pb = w.asDiagonal() * b - w * ((w.transpose() * b) / total);
      const Eigen::Matrix<double, 6, 6> local = b.transpose() * pb;
      system.add(f, local);
      const double t = ideal[f].sum() - pi;
      const Vec6 share = b.transpose() * (ideal[f] - alpha[f] - w * (t / total));
      for (int k = 0; k < 3; ++k) {
        if (faces[f][k] >= 0) rhs.segment<2>(2 * faces[f][k]) += share.segment<2>(2 * k);
      }
    }
    if (!system.factor(1e-10 * system.mean_diagonal(), context)) break;
    const Eigen::VectorXd x = system.solve(rhs);
    if (!x.allFinite()) break;
    for (int f = 0; f < n; ++f) {
      const Mat36 b = constraint_jacobian(alpha[f]);
      const Vec3& w = inverse_weight[f];
      Vec6 multipliers = Vec6::Zero();
      for (int k = 0; k < 3; ++k) {
        if (faces[f][k] >= 0) multipliers.segment<2>(2 * k) = x.segment<2>(2 * faces[f][k]);
      }
      const Vec3 bx = b * multipliers;
      const double triangle = (ideal[f].sum() - pi - w.dot(bx)) / w.sum();
      Vec3 next = ideal[f] - w.cwiseProduct(bx + Vec3::Constant(triangle));
      for (int k = 0; k < 3; ++k)
        next[k] = std::clamp(next[k], 0.2 * least_angle, pi - 0.4 * least_angle);
      alpha[f] = next;
    }
  }

  std::vector<RestTriangle> shapes(n);
  for (int f = 0; f < n; ++f) {
    const Vec3 a = best[f] * (pi / best[f].sum());
    const double s0 = std::sin(a[0]), s1 = std::sin(a[1]), s2 = std::sin(a[2]);
    const double scale = std::sqrt(2.0 * rest[f].area() / (s0 * s1 * s2));
    shapes[f] = {scale * s2, scale * std::cos(a[0]) * s1, scale * s0 * s1};
  }
  return shapes;
}

}  // namespace partuv
