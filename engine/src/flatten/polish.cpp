// Projected Newton on an isotropic distortion energy with a barrier against flips.
// Eigensystems of isotropic energies in 2D: Smith, de Goes, Kim 2019.
#include <algorithm>
#include <cmath>

#include "flatten/system.hpp"
#include "partuv/flatten.hpp"

namespace partuv {
namespace {

using Mat2 = Eigen::Matrix2d;

/// The inverse of a rest triangle's edge matrix, and its share of the energy.
struct Element {
  Mat2 inverse_rest;
  double weight;
};

Mat2 edges(const Triangle& t, const std::vector<Vec2>& uv) {
  Mat2 m;
  m.col(0) = uv[t[1]] - uv[t[0]];
  m.col(1) = uv[t[2]] - uv[t[0]];
  return m;
}

/// Energy density of a Jacobian; infinite where it flips.
double density(const Mat2& j, const PolishOptions& o) {
  const double d = j.determinant();
  if (!(d > 0.0)) return std::numeric_limits<double>::infinity();
  const double angle = 0.5 * j.squaredNorm() / d - 1.0;
  const double area = 0.5 * (d + 1.0 / d) - 1.0;
  return o.angle_weight * angle + o.area_weight * area;
}

double energy(const std::vector<Triangle>& faces, const std::vector<Element>& elements,
              const std::vector<Vec2>& uv, const PolishOptions& o) {
  double sum = 0.0;
  for (size_t f = 0; f < faces.size(); ++f) {
    const double e = density(edges(faces[f], uv) * elements[f].inverse_rest, o);
    if (!(e < 1e300)) return std::numeric_limits<double>::infinity();
    sum += elements[f].weight * e;
  }
  return sum;
}

/// Signed singular value decomposition j = u diag(s) v^T with rotations u, v; s1 >= |s2|.
void decompose(const Mat2& j, Mat2& u, Vec2& s, Mat2& v) {
  const double e = 0.5 * (j(0, 0) + j(1, 1)), f = 0.5 * (j(0, 0) - j(1, 1));
  const double g = 0.5 * (j(1, 0) + j(0, 1)), h = 0.5 * (j(1, 0) - j(0, 1));
  const double q = std::hypot(e, h), r = std::hypot(f, g);
  s = Vec2(q + r, q - r);
  const double a1 = std::atan2(g, f), a2 = std::atan2(h, e);
  const double left = 0.5 * (a2 + a1), right = 0.5 * (a2 - a1);
  u << std::cos(left), -std::sin(left), std::sin(left), std::cos(left);
  v << std::cos(right), std::sin(right), -std::sin(right), std::cos(right);
}

/// Gradient and projected Hessian of one element over its six coordinates (vertex-major).
void local_system(const Mat2& j, const Element& element, const PolishOptions& o,
                  Eigen::Matrix<double, 6, 1>& gradient, Eigen::Matrix<double, 6, 6>& hessian) {
  Mat2 u, v;
  Vec2 s;
  decompose(j, u, s, v);
  const double s1 = s.x(), s2 = std::max(s.y(), 1e-12);
  const double d = s1 * s2, d2 = d * d;
  const double a = o.angle_weight, b = o.area_weight;
  const double g1 = 0.5 * (1.0 - 1.0 / d2), g2 = 1.0 / (d * d2);  // g(d) = (d + 1/d) / 2
  const double f1 = a * 0.5 * (1.0 / s2 - s2 / (s1 * s1)) + b * g1 * s2;
  const double f2 = a * 0.5 * (1.0 / s1 - s1 / (s2 * s2)) + b * g1 * s1;
  const double h11 = a * s2 / (s1 * s1 * s1) + b * g2 * s2 * s2;
  const double h22 = a * s1 / (s2 * s2 * s2) + b * g2 * s1 * s1;
  const double h12 = -0.5 * a * (1.0 / (s1 * s1) + 1.0 / (s2 * s2)) + b * (g2 * d + g1);
  const double twist = -0.5 * a * (s1 - s2) * (s1 - s2) / d2 + b * g1;
  const double flip = 0.5 * a * (1.0 / d + (s1 * s1 + d + s2 * s2) / d2) - b * g1;

  // Eigenvalues and vectors of the scaling block, negative ones dropped.
  const double mean = 0.5 * (h11 + h22), half = 0.5 * (h11 - h22);
  const double spread = std::hypot(half, h12);
  const double angle = 0.5 * std::atan2(h12, half);
  const double c = std::cos(angle), n = std::sin(angle);
  Mat2 modes[4];
  double values[4] = {std::max(mean + spread, 0.0), std::max(mean - spread, 0.0),
                      std::max(twist, 0.0), std::max(flip, 0.0)};
  modes[0] << c, 0.0, 0.0, n;
  modes[1] << -n, 0.0, 0.0, c;
  constexpr double r = 0.70710678118654752440;
  modes[2] << 0.0, -r, r, 0.0;
  modes[3] << 0.0, r, r, 0.0;

  // J = sum over corners of u_k g_k^T: rows of the gradient operator.
  const Mat2& m = element.inverse_rest;
  const Vec2 g[3] = {Vec2(-m(0, 0) - m(1, 0), -m(0, 1) - m(1, 1)), Vec2(m(0, 0), m(0, 1)),
                     Vec2(m(1, 0), m(1, 1))};
  Mat2 stress = f1 * u.col(0) * v.col(0).transpose() + f2 * u.col(1) * v.col(1).transpose();
  for (int k = 0; k < 3; ++k) gradient.segment<2>(2 * k) = element.weight * (stress * g[k]);
  hessian.setZero();
  for (int i = 0; i < 4; ++i) {
    if (values[i] <= 0.0) continue;
    const Mat2 mode = u * modes[i] * v.transpose();
    Eigen::Matrix<double, 6, 1> column;
    for (int k = 0; k < 3; ++k) column.segment<2>(2 * k) = mode * g[k];
    hessian.noalias() += (element.weight * values[i]) * column * column.transpose();
  }
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

bool polish(const Piece& piece, const std::vector<RestTriangle>& rest, const PolishOptions& options,
            const std::function<bool()>& enough, const Context& context, MeshSystem<2>& system,
            std::vector<Vec2>& uv) {
  const std::vector<Triangle>& faces = piece.surface.faces;
  const int n = static_cast<int>(faces.size());
  double area = 0.0, count = 0.0;
  std::vector<double> faces_meant(n);
  for (int f = 0; f < n; ++f) {
    const double true_area = 0.5 * face_cross(piece.surface, f).norm();
    faces_meant[f] = true_area > options.least_area ? piece.weight[f] : 0.0;
    area += rest[f].area();
    count += faces_meant[f];
  }
  if (!(count > 0.0)) count = 1.0;
  // Half by area, for the map; half by faces, since the paper's figures count faces.
  std::vector<Element> elements(n);
  for (int f = 0; f < n; ++f) {
    const RestTriangle& r = rest[f];
    elements[f].inverse_rest << 1.0 / r.length, -r.x / (r.length * r.y), 0.0, 1.0 / r.y;
    elements[f].weight = 0.5 * r.area() / area + 0.5 * faces_meant[f] / count;
  }
  double current = energy(faces, elements, uv, options);
  if (!std::isfinite(current)) return false;

  Eigen::VectorXd gradient(2 * uv.size());
  std::vector<Vec2> step(uv.size()), trial(uv.size());
  for (int taken = 0; taken < options.steps && !context.stopping(); ++taken) {
    if (enough()) return true;
    system.clear();
    gradient.setZero();
    Eigen::Matrix<double, 6, 1> local_gradient;
    Eigen::Matrix<double, 6, 6> local_hessian;
    for (int f = 0; f < n; ++f) {
      local_system(edges(faces[f], uv) * elements[f].inverse_rest, elements[f], options,
                   local_gradient, local_hessian);
      system.add(f, local_hessian);
      for (int k = 0; k < 3; ++k) {
        gradient.segment<2>(2 * faces[f][k]) += local_gradient.segment<2>(2 * k);
      }
    }
    if (!system.factor(1e-9 * system.mean_diagonal(), context)) return false;
    const Eigen::VectorXd x = system.solve(-gradient);
    if (!x.allFinite()) return false;
    const double slope = gradient.dot(x);
    if (!(slope < 0.0)) return true;
    for (size_t v = 0; v < uv.size(); ++v) step[v] = x.segment<2>(2 * v);
    double length = std::min(1.0, 0.9 * longest_step(faces, uv, step));
    double next = current;
    bool lower = false;
    for (int halving = 0; halving < 12 && !lower; ++halving) {
      for (size_t v = 0; v < uv.size(); ++v) trial[v] = uv[v] + length * step[v];
      next = energy(faces, elements, trial, options);
      lower = next <= current + 1e-4 * length * slope;
      if (!lower) length *= 0.5;
    }
    if (!lower) return true;
    uv.swap(trial);
    const bool done = current - next <= options.least_decrease * current;
    current = next;
    if (done) return true;
  }
  return false;
}

}  // namespace partuv
