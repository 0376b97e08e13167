#pragma once

#include <vector>

#include "partuv/solve.hpp"

namespace partuv {

/// Make charts that the grid of single precision cannot hold a little larger than they are: specks
/// about a tenth of a texel at 1024, and lone needles thick enough to keep an area. On a surface of
/// unit area.
void fit_to_single_precision(std::vector<SolvedChart>& solved);

}  // namespace partuv
