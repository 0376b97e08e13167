#pragma once

#include <cstdint>
#include <vector>

#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// How one pass places the charts.
struct GreedyPlan {
  int cells = 256;       ///< along a side of the bin
  int rotations = 4;     ///< turns tried per chart, evenly over a full turn
  uint64_t variant = 0;  ///< 0: largest first; other values shuffle a little, each in its own way
};

/// Place the charts one by one, each as low as it goes and then as far left, at a given scale
/// (texels per outline unit). Returns a layout of scale 0 when they do not all fit or the context
/// stops. Rests on cells touched, so the gutter holds by construction.
Layout greedy(const std::vector<Outline>& charts, const Bin& bin, double scale,
              const GreedyPlan& plan, const Context& context);

}  // namespace partuv::packing
