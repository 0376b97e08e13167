#pragma once

#include <vector>

#include "partuv/context.hpp"
#include "partuv/options.hpp"
#include "partuv/solve.hpp"

namespace partuv {

/// Cut charts in two that alone would keep the efficiency of the atlas below
/// `options.cut_below_efficiency`, as long as that gains enough for a chart more. Two cuts at most,
/// or three where they double what can be reached. The sides of a cut take the place of their
/// chart. weight: texel density of each chart relative to others.
void shorten_charts(const Options& options, const FlattenOptions& bounds,
                    const std::vector<double>& weight, const Context& context,
                    std::vector<SolvedChart>& charts);

}  // namespace partuv
