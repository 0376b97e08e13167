// Projected Newton on an isotropic distortion energy. Eigensystems of isotropic energies in 2D:
// Smith, de Goes, Kim 2019.
#include "flatten/newton.hpp"

#include <algorithm>
#include <cmath>

namespace partuv {
namespace {

using Mat2 = Eigen::Matrix2d;

Mat2 edges(const Triangle& t, const std::vector<Vec2>& uv) {
  Mat2 m;
  m.col(0) = uv[t[1]] - uv[t[0]];
  m.col(1) = uv[t[2]] - uv[t[0]];
  return m;
}

/// Cosine and sine of an angle.
struct Direction {
  double c = 1.0, s = 0.0;

  static Direction of(double x, double y) {
    const double length = std::sqrt(x * x + y * y);
    return length > 0.0 ? Direction{x / length, y / length} : Direction{};
  }
  Direction plus(const Direction& o) const { return {c * o.c - s * o.s, s * o.c + c * o.s}; }
  Direction minus(const Direction& o) const { return {c * o.c + s * o.s, s * o.c - c * o.s}; }
  /// Half the angle, which lies in (-pi, pi].
  Direction half() const {
    if (c >= 0.0) {
      const double cosine = std::sqrt(0.5 * (1.0 + c));
      return {cosine, 0.5 * s / cosine};
    }
    const double sine = std::copysign(std::sqrt(0.5 * (1.0 - c)), s);
    return {0.5 * s / sine, sine};
  }
};

/// Signed singular value decomposition j = u diag(s) v^T with rotations u, v; s1 >= |s2|. Their
/// angles are half the sum and half the difference of two that j shows.
void decompose(const Mat2& j, Mat2& u, Vec2& s, Mat2& v) {
  const double e = 0.5 * (j(0, 0) + j(1, 1)), f = 0.5 * (j(0, 0) - j(1, 1));
  const double g = 0.5 * (j(1, 0) + j(0, 1)), h = 0.5 * (j(1, 0) - j(0, 1));
  const double q = std::sqrt(e * e + h * h), r = std::sqrt(f * f + g * g);
  s = Vec2(q + r, q - r);
  const Direction turned = Direction::of(e, h);
  const Direction left = turned.plus(Direction::of(f, g)).half(), right = turned.minus(left);
  u << left.c, -left.s, left.s, left.c;
  v << right.c, right.s, -right.s, right.c;
}

/// Energy density of a Jacobian with singular values s: N(s) q(d) less a constant, with d = s1 s2,
/// N = a (s1^2 + s2^2) / 2 + b (d^2 + 1) / 2 and q = 1 / d; see PolishOptions. Where epsilon > 0,
/// q = 1 / x(d) with x = (d + sqrt(epsilon^2 + d^2)) / 2, which is finite for flipped faces too
/// (Garanzha et al. 2021, Foldover-free maps).
struct Density {
  double a, b, epsilon;

  double smooth(double d) const {
    if (epsilon == 0.0) return d;
    const double root = std::sqrt(epsilon * epsilon + d * d);
    // The same for negative d without cancellation.
    return d >= 0.0 ? 0.5 * (d + root) : 0.5 * epsilon * epsilon / (root - d);
  }

  double operator()(const Mat2& j) const {
    const double d = j.determinant(), x = smooth(d);
    if (!(x > 0.0)) return std::numeric_limits<double>::infinity();
    return 0.5 * (a * j.squaredNorm() + b * (d * d + 1.0)) / x - a - b;
  }
};

/// Gradient and projected Hessian of one element over its corners.
struct LocalSystem {
  Vec2 gradient[3];
  Mat2 hessian[3][3];

  double operator()(int row, int column) const {
    return hessian[row / 2][column / 2](row % 2, column % 2);
  }
};

LocalSystem local_system(const Mat2& j, const Mat2& inverse_rest, double weight,
                         const Density& density) {
  Mat2 u, v;
  Vec2 s;
  decompose(j, u, s, v);
  const double a = density.a, b = density.b, epsilon = density.epsilon;
  const double s1 = s.x(), s2 = epsilon > 0.0 ? s.y() : std::max(s.y(), 1e-12);
  const double d = s1 * s2, x = density.smooth(d), root = std::sqrt(epsilon * epsilon + d * d);
  const double dx = x / root, ddx = 0.5 * epsilon * epsilon / (root * root * root);
  // Value and derivatives by d of q, and by s1 and s2 of N.
  const double q = 1.0 / x, dq = -dx / (x * x), ddq = (2.0 * dx * dx / x - ddx) / (x * x);
  const double n = 0.5 * a * (s1 * s1 + s2 * s2) + 0.5 * b * (d * d + 1.0);
  const double n1 = a * s1 + b * d * s2, n2 = a * s2 + b * d * s1;
  const double f1 = n1 * q + n * dq * s2, f2 = n2 * q + n * dq * s1;
  const double h11 = (a + b * s2 * s2) * q + 2.0 * n1 * dq * s2 + n * ddq * s2 * s2;
  const double h22 = (a + b * s1 * s1) * q + 2.0 * n2 * dq * s1 + n * ddq * s1 * s1;
  const double h12 = 2.0 * b * d * q + (n1 * s1 + n2 * s2 + n) * dq + n * ddq * d;
  const double twist = (a + b * d) * q + n * dq;  // (f1 + f2) / (s1 + s2)
  const double flip = (a - b * d) * q - n * dq;   // (f1 - f2) / (s1 - s2)

  // Eigenvalues and vectors of the scaling block, negative ones dropped.
  const double mean = 0.5 * (h11 + h22), half = 0.5 * (h11 - h22);
  const double spread = std::sqrt(half * half + h12 * h12);
  const auto [c, e] = Direction::of(half, h12).half();
  const double high = weight * std::max(mean + spread, 0.0);
  const double low = weight * std::max(mean - spread, 0.0);
  const double xx = high * c * c + low * e * e, xy = (high - low) * c * e;
  const double yy = high * e * e + low * c * c;
  const double twisting = 0.5 * weight * std::max(twist, 0.0);
  const double flipping = 0.5 * weight * std::max(flip, 0.0);
  const double even = flipping + twisting, odd = flipping - twisting;

  // J = sum over corners of x_k g_k^T: rows of the gradient operator, in the frame of v; everything
  // is summed up in the frames of u and v, and turned by u in the end.
  LocalSystem local;
  Vec2 g[3];
  g[1] = v.transpose() * inverse_rest.row(0).transpose();
  g[2] = v.transpose() * inverse_rest.row(1).transpose();
  g[0] = -g[1] - g[2];
  for (int k = 0; k < 3; ++k) {
    local.gradient[k] = weight * (u * Vec2(f1 * g[k].x(), f2 * g[k].y()));
    for (int l = k; l < 3; ++l) {
      const Vec2 &own = g[k], &other = g[l];
      Mat2 h;
      h << xx * own.x() * other.x() + even * own.y() * other.y(),
          xy * own.x() * other.y() + odd * own.y() * other.x(),
          xy * own.y() * other.x() + odd * own.x() * other.y(),
          yy * own.y() * other.y() + even * own.x() * other.x();
      local.hessian[k][l] = u * h * u.transpose();
      local.hessian[l][k] = local.hessian[k][l].transpose();
    }
  }
  return local;
}

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
    const double e = density(jacobian(f, uv));
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
  for (size_t f = 0; f < faces_.size(); ++f) {
    const LocalSystem local =
        local_system(jacobian(f, uv), elements_[f].inverse_rest, elements_[f].weight, density);
    system_.add(static_cast<int>(f), local);
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

Newton::Mat2 Newton::jacobian(size_t f, const std::vector<Vec2>& uv) const {
  return edges(faces_[f], uv) * elements_[f].inverse_rest;
}

}  // namespace partuv
