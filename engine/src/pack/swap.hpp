#pragma once

#include <vector>

#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// Let charts of different groups take each other's place where that brings the charts of groups
/// nearer to each other, and a layout at the scale `target` or above comes of it. `layout` is one.
void swap_together(const std::vector<Outline>& charts, const std::vector<std::vector<int>>& groups,
                   const Bin& bin, double target, double effort, Layout& layout,
                   const Context& context);

}  // namespace partuv::packing
