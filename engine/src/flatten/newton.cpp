#include "flatten/newton.hpp"

#include <algorithm>
#include <cmath>

namespace partuv {
namespace {

using Mat2 = Eigen::Matrix2d;

constexpr int batches_per_task = 16;

Mat2 edges(const Triangle& t, const std::vector<Vec2>& uv) {
  Mat2 m;
  m.col(0) = uv[t[1]] - uv[t[0]];
  m.col(1) = uv[t[2]] - uv[t[0]];
  return m;
}

/// The density of one Jacobian.
double energy_density(const Density& density, const Mat2& j) {
  const double d = j.determinant(), epsilon = density.epsilon;
  const double x = epsilon > 0.0 ? smoothed(d, std::sqrt(epsilon * epsilon + d * d), epsilon) : d;
  if (!(x > 0.0)) return std::numeric_limits<double>::infinity();
  return 0.5 * (density.a * j.squaredNorm() + density.b * (d * d + 1.0)) / x - density.a -
         density.b;
}

/// One face of a batch, over all its corners.
struct LocalSystem {
  Vec2 gradient[3];
  Mat2 hessian[3][3];

  LocalSystem(const BatchSystem& batch, int i) {
    const auto h = [&](int entry) { return batch.hessian[entry][i]; };
    for (int k = 0; k < 2; ++k) {
      gradient[k + 1] = Vec2(batch.gradient[2 * k][i], batch.gradient[2 * k + 1][i]);
    }
    gradient[0] = -gradient[1] - gradient[2];
    hessian[1][1] << h(0), h(1), h(1), h(2);
    hessian[1][2] << h(3), h(4), h(5), h(6);
    hessian[2][2] << h(7), h(8), h(8), h(9);
    hessian[2][1] = hessian[1][2].transpose();
    for (int k = 1; k < 3; ++k) {
      hessian[k][0] = -hessian[k][1] - hessian[k][2];
      hessian[0][k] = hessian[k][0].transpose();
    }
    hessian[0][0] = -hessian[1][0] - hessian[2][0];
  }

  double operator()(int row, int column) const {
    return hessian[row / 2][column / 2](row % 2, column % 2);
  }
};

/// The largest step along `step` before some face would lose its area.
double longest_step(const std::vector<Triangle>& faces, const std::vector<Vec2>& uv,
                    const std::vector<Vec2>& step) {
  double longest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : faces) {
    const Mat2 e = edges(t, uv), s = edges(t, step);
    const double c = e.determinant(), a = s.determinant();
    const double b = e(0, 0) * s(1, 1) + s(0, 0) * e(1, 1) - e(0, 1) * s(1, 0) - s(0, 1) * e(1, 0);
    // Smallest positive root of a t^2 + b t + c, with c > 0.
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0) continue;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    for (const double root : {a != 0.0 ? q / a : -1.0, q != 0.0 ? c / q : -1.0}) {
      if (root > 0.0) longest = std::min(longest, root);
    }
  }
  return longest;
}

}  // namespace

Newton::Newton(const Piece& piece, const std::vector<RestTriangle>& rest,
               const PolishOptions& options, const Context& context, MeshSystem<2>& system)
    : faces_(piece.surface.faces),
      options_(options),
      context_(context),
      system_(system),
      batches_((faces_.size() + ElementBatch::most - 1) / ElementBatch::most),
      gradient_(2 * piece.surface.positions.size()) {
  double area = 0.0, count = 0.0;
  std::vector<double> meant(faces_.size());
  for (size_t f = 0; f < faces_.size(); ++f) {
    const double true_area = 0.5 * face_cross(piece.surface, static_cast<int>(f)).norm();
    meant[f] = true_area > options.least_area ? piece.weight[f] : 0.0;
    area += rest[f].area();
    count += meant[f];
  }
  if (!(count > 0.0)) count = 1.0;
  // Half by area, for the map; half by faces, since the paper's figures count faces.
  elements_.resize(faces_.size());
  for (size_t f = 0; f < faces_.size(); ++f) {
    const RestTriangle& r = rest[f];
    elements_[f].inverse_rest << 1.0 / r.length, -r.x / (r.length * r.y), 0.0, 1.0 / r.y;
    elements_[f].weight = 0.5 * r.area() / area + 0.5 * meant[f] / count;
  }
}

double Newton::energy(const std::vector<Vec2>& uv, double epsilon) const {
  const Density density{options_.angle_weight, options_.area_weight, epsilon};
  double sum = 0.0;
  for (size_t f = 0; f < faces_.size(); ++f) {
    const double e = energy_density(density, jacobian(f, uv));
    if (!(e < 1e300)) return std::numeric_limits<double>::infinity();
    sum += elements_[f].weight * e;
  }
  for (size_t i = 0; i < springs_.vertex.size(); ++i) {
    sum += 0.5 * springs_.stiffness * (uv[springs_.vertex[i]] - springs_.target[i]).squaredNorm();
  }
  return sum;
}

double Newton::least_determinant(const std::vector<Vec2>& uv) const {
  double least = std::numeric_limits<double>::infinity();
  for (size_t f = 0; f < faces_.size(); ++f) {
    least = std::min(least, jacobian(f, uv).determinant());
  }
  return least;
}

double Newton::direction(const std::vector<Vec2>& uv, double epsilon, std::vector<Vec2>& step) {
  const Density density{options_.angle_weight, options_.area_weight, epsilon};
  system_.clear();
  gradient_.setZero();
  const int face_count = static_cast<int>(faces_.size());
  parallel_for(
      context_, static_cast<int>(batches_.size() + batches_per_task - 1) / batches_per_task,
      [&](int task) {
        const int end = std::min((task + 1) * batches_per_task, static_cast<int>(batches_.size()));
        for (int b = task * batches_per_task; b < end; ++b) {
          local_systems(batch_of(b, uv), density, batches_[b]);
        }
      });
  for (int f = 0; f < face_count; ++f) {
    const LocalSystem local(batches_[f / ElementBatch::most], f % ElementBatch::most);
    system_.add(f, local);
    for (int k = 0; k < 3; ++k) gradient_.segment<2>(2 * faces_[f][k]) += local.gradient[k];
  }
  for (size_t i = 0; i < springs_.vertex.size(); ++i) {
    const int v = springs_.vertex[i];
    gradient_.segment<2>(2 * v) += springs_.stiffness * (uv[v] - springs_.target[i]);
    for (int d = 0; d < 2; ++d) system_.add_diagonal(v, d, springs_.stiffness);
  }
  const double pin = 1e6 * system_.mean_diagonal();
  for (size_t v = 0; v < options_.fixed.size(); ++v) {
    if (!options_.fixed[v]) continue;
    gradient_.segment<2>(2 * v).setZero();
    for (int d = 0; d < 2; ++d) system_.add_diagonal(static_cast<int>(v), d, pin);
  }
  if (!system_.factor(1e-9 * system_.mean_diagonal(), context_)) return 0.0;
  const Eigen::VectorXd x = system_.solve(-gradient_);
  if (!x.allFinite()) return 0.0;
  for (size_t v = 0; v < uv.size(); ++v) {
    step[v] = x.segment<2>(2 * v);
    if (!options_.fixed.empty() && options_.fixed[v]) step[v].setZero();
  }
  return gradient_.dot(x);
}

double Newton::safe_length(const std::vector<Vec2>& uv, const std::vector<Vec2>& step) const {
  return std::min(1.0, 0.9 * longest_step(faces_, uv, step));
}

double Newton::descend(std::vector<Vec2>& uv, const std::vector<Vec2>& step, double length,
                       double slope, double epsilon, double current) const {
  std::vector<Vec2> trial(uv.size());
  for (int halving = 0; halving < 12; ++halving, length *= 0.5) {
    for (size_t v = 0; v < uv.size(); ++v) trial[v] = uv[v] + length * step[v];
    const double next = energy(trial, epsilon);
    if (!(next <= current + 1e-4 * length * slope)) continue;
    uv.swap(trial);
    return next;
  }
  return current;
}

ElementBatch Newton::batch_of(int number, const std::vector<Vec2>& uv) const {
  ElementBatch batch;
  const int first = number * ElementBatch::most;
  for (int i = 0; i < ElementBatch::most; ++i) {
    // The last batch is filled up with its last face.
    const size_t f = std::min<size_t>(first + i, faces_.size() - 1);
    const Mat2 j = jacobian(f, uv), &rest = elements_[f].inverse_rest;
    for (int k = 0; k < 4; ++k) batch.jacobian[k][i] = j(k % 2, k / 2);
    batch.inverse_rest[0][i] = rest(0, 0);
    batch.inverse_rest[1][i] = rest(0, 1);
    batch.inverse_rest[2][i] = rest(1, 1);
    batch.weight[i] = elements_[f].weight;
  }
  return batch;
}

Newton::Mat2 Newton::jacobian(size_t f, const std::vector<Vec2>& uv) const {
  return edges(faces_[f], uv) * elements_[f].inverse_rest;
}

}  // namespace partuv
