#include "flatten/elements.hpp"

#include <algorithm>
#include <cmath>

namespace partuv {
namespace {

/// Cosine and sine of an angle. Free of branches, for the sake of wide registers.
struct Direction {
  double c, s;

  PARTUV_INLINE static Direction of(double x, double y) {
    const double length = std::sqrt(x * x + y * y);
    const double inverse = length > 0.0 ? 1.0 / length : 0.0;
    return {length > 0.0 ? x * inverse : 1.0, y * inverse};
  }
  PARTUV_INLINE Direction plus(const Direction& o) const {
    return {c * o.c - s * o.s, s * o.c + c * o.s};
  }
  PARTUV_INLINE Direction minus(const Direction& o) const {
    return {c * o.c + s * o.s, s * o.c - c * o.s};
  }
  /// Half the angle, which lies in (-pi, pi].
  PARTUV_INLINE Direction half() const {
    const double longer = std::sqrt(0.5 * (1.0 + std::abs(c)));
    const double shorter = 0.5 * s / longer;
    return {c >= 0.0 ? longer : std::abs(shorter), c >= 0.0 ? shorter : std::copysign(longer, s)};
  }
};

/// The function q and its derivatives at d.
struct Barrier {
  double value, first, second;
};

template <bool Smooth>
PARTUV_INLINE Barrier barrier(double d, double epsilon) {
  if constexpr (!Smooth) {
    const double inverse = 1.0 / d;
    return {inverse, -inverse * inverse, 2.0 * inverse * inverse * inverse};
  }
  const double root = std::sqrt(epsilon * epsilon + d * d);
  const double x = smoothed(d, root, epsilon);
  const double dx = x / root, ddx = 0.5 * epsilon * epsilon / (root * root * root);
  return {1.0 / x, -dx / (x * x), (2.0 * dx * dx / x - ddx) / (x * x)};
}

/// Row of the gradient operator.
struct Scaled {
  double x, y;
};

struct Block {
  double xx, xy, yx, yy;
};

template <bool Smooth>
PARTUV_INLINE void local_system(const ElementBatch& batch, const Density& density, int i,
                                BatchSystem& out) {
  // Signed singular values s1 >= |s2| of the Jacobian, u diag(s) v^T with rotations u and v, whose
  // angles are half the sum and half the difference of two that the Jacobian shows.
  const double j00 = batch.jacobian[0][i], j10 = batch.jacobian[1][i];
  const double j01 = batch.jacobian[2][i], j11 = batch.jacobian[3][i];
  const double e = 0.5 * (j00 + j11), f = 0.5 * (j00 - j11);
  const double g = 0.5 * (j10 + j01), h = 0.5 * (j10 - j01);
  const double even_part = std::sqrt(e * e + h * h), odd_part = std::sqrt(f * f + g * g);
  const Direction turned = Direction::of(e, h);
  const Direction u = turned.plus(Direction::of(f, g)).half(), v = u.minus(turned);
  const double s1 = even_part + odd_part, difference = even_part - odd_part;
  const double s2 = Smooth ? difference : std::max(difference, 1e-12);

  // Value and derivatives by d of q, and by s1 and s2 of N.
  const double a = density.a, b = density.b, d = s1 * s2;
  const auto [q, dq, ddq] = barrier<Smooth>(d, density.epsilon);
  const double n = 0.5 * a * (s1 * s1 + s2 * s2) + 0.5 * b * (d * d + 1.0);
  const double n1 = a * s1 + b * d * s2, n2 = a * s2 + b * d * s1;
  const double weight = batch.weight[i];
  const double f1 = weight * (n1 * q + n * dq * s2), f2 = weight * (n2 * q + n * dq * s1);
  const double h11 = (a + b * s2 * s2) * q + 2.0 * n1 * dq * s2 + n * ddq * s2 * s2;
  const double h22 = (a + b * s1 * s1) * q + 2.0 * n2 * dq * s1 + n * ddq * s1 * s1;
  const double h12 = 2.0 * b * d * q + (n1 * s1 + n2 * s2 + n) * dq + n * ddq * d;
  const double twist = (a + b * d) * q + n * dq;  // (f1 + f2) / (s1 + s2)
  const double flip = (a - b * d) * q - n * dq;   // (f1 - f2) / (s1 - s2)

  // Eigenvalues and vectors of the scaling block, negative ones dropped.
  const double mean = 0.5 * (h11 + h22), half = 0.5 * (h11 - h22);
  const double spread = std::sqrt(half * half + h12 * h12);
  const Direction axis = Direction::of(half, h12).half();
  const double high = weight * std::max(mean + spread, 0.0);
  const double low = weight * std::max(mean - spread, 0.0);
  const double xx = high * axis.c * axis.c + low * axis.s * axis.s;
  const double xy = (high - low) * axis.c * axis.s;
  const double yy = high * axis.s * axis.s + low * axis.c * axis.c;
  const double twisting = 0.5 * weight * std::max(twist, 0.0);
  const double flipping = 0.5 * weight * std::max(flip, 0.0);
  const double even = flipping + twisting, odd = flipping - twisting;

  // J = sum over corners of x_k g_k^T: rows of the gradient operator, in the frame of v; everything
  // is summed up in the frames of u and v, and turned by u in the end.
  const double r00 = batch.inverse_rest[0][i], r01 = batch.inverse_rest[1][i];
  const double r11 = batch.inverse_rest[2][i];
  const Scaled first{v.c * r00 + v.s * r01, v.c * r01 - v.s * r00}, second{v.s * r11, v.c * r11};
  const double first_x = f1 * first.x, first_y = f2 * first.y;
  const double second_x = f1 * second.x, second_y = f2 * second.y;
  out.gradient[0][i] = u.c * first_x - u.s * first_y;
  out.gradient[1][i] = u.s * first_x + u.c * first_y;
  out.gradient[2][i] = u.c * second_x - u.s * second_y;
  out.gradient[3][i] = u.s * second_x + u.c * second_y;
  const double cc = u.c * u.c, ss = u.s * u.s, cs = u.c * u.s;
  const auto block = [&](const Scaled& own, const Scaled& other) -> Block {
    const double m00 = xx * own.x * other.x + even * own.y * other.y;
    const double m01 = xy * own.x * other.y + odd * own.y * other.x;
    const double m10 = xy * own.y * other.x + odd * own.x * other.y;
    const double m11 = yy * own.y * other.y + even * own.x * other.x;
    const double across = cs * (m00 - m11), mixed = cs * (m01 + m10);
    return {cc * m00 - mixed + ss * m11, across + cc * m01 - ss * m10, across + cc * m10 - ss * m01,
            ss * m00 + mixed + cc * m11};
  };
  const Block h11b = block(first, first), h12b = block(first, second), h22b = block(second, second);
  out.hessian[0][i] = h11b.xx;
  out.hessian[1][i] = h11b.xy;
  out.hessian[2][i] = h11b.yy;
  out.hessian[3][i] = h12b.xx;
  out.hessian[4][i] = h12b.xy;
  out.hessian[5][i] = h12b.yx;
  out.hessian[6][i] = h12b.yy;
  out.hessian[7][i] = h22b.xx;
  out.hessian[8][i] = h22b.xy;
  out.hessian[9][i] = h22b.yy;
}

}  // namespace

PARTUV_WIDE void local_systems(const ElementBatch& batch, const Density& density,
                               BatchSystem& system) {
  if (density.epsilon > 0.0) {
    for (int i = 0; i < ElementBatch::most; ++i) local_system<true>(batch, density, i, system);
  } else {
    for (int i = 0; i < ElementBatch::most; ++i) local_system<false>(batch, density, i, system);
  }
}

}  // namespace partuv
