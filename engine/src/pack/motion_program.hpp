#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "partuv/context.hpp"

namespace partuv::packing {

/// One linear limit on the motion: a . x(one) + b . x(two) + growth * x(scale) >= least. A chart's
/// x are its two shifts and its turn, all in texels; chart `two` may be -1 for none.
struct MotionLimit {
  int32_t one;
  int32_t two;
  std::array<double, 3> a;
  std::array<double, 3> b;
  double growth;
  double least;
};

struct Motion {
  std::vector<std::array<double, 3>> charts;
  double growth = 0.0;
  bool solved = false;
  int steps = 0;  ///< factorisations it took
};

/// The motion of `count` charts that lets the common scale grow most within the limits, every
/// variable kept in [-trust, trust]. A linear program, solved by Mehrotra's predictor-corrector
/// interior-point method (SIAM J. Optim. 2, 1992) with sparse normal equations: about a dozen
/// factorisations of a matrix with one 3 x 3 block per chart and per pair of charts in touch. Gives
/// up when the context stops.
Motion solve_motion(const std::vector<MotionLimit>& limits, int count, double trust,
                    const Context& context);

}  // namespace partuv::packing
