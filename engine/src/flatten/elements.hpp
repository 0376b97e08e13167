#pragma once

#include "wide.hpp"

namespace partuv {

/// Energy density of a Jacobian with singular values s: N(s) q(d) less a constant, with d = s1 s2,
/// N = a (s1^2 + s2^2) / 2 + b (d^2 + 1) / 2 and q = 1 / d; see PolishOptions. Where epsilon > 0,
/// q = 1 / x(d) with x = (d + sqrt(epsilon^2 + d^2)) / 2, which is finite for flipped faces too
/// (Garanzha et al. 2021, Foldover-free maps).
struct Density {
  double a, b, epsilon;
};

/// x(d) where epsilon > 0; root: sqrt(epsilon^2 + d^2). For negative d without cancellation.
PARTUV_INLINE double smoothed(double d, double root, double epsilon) {
  return d >= 0.0 ? 0.5 * (d + root) : 0.5 * epsilon * epsilon / (root - d);
}

/// Up to 64 faces, each field as an array, so that loops over faces use wide registers.
struct ElementBatch {
  static constexpr int most = 64;
  double jacobian[4][most];      ///< by columns
  double inverse_rest[3][most];  ///< upper triangle of the inverse edge matrix, by columns
  double weight[most];
};

/// Gradients and projected Hessians of the energy over the corners 1 and 2 of each face; what they
/// sum up to with the sign turned belongs to corner 0.
struct BatchSystem {
  double gradient[4][ElementBatch::most];
  double hessian[10][ElementBatch::most];  ///< 11: xx xy yy; 12: xx xy yx yy; 22: xx xy yy
};

/// Eigensystems of isotropic energies in 2D: Smith, de Goes, Kim 2019.
void local_systems(const ElementBatch& batch, const Density& density, BatchSystem& system);

}  // namespace partuv
