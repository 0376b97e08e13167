#pragma once

#include <vector>

#include "partuv/context.hpp"
#include "partuv/surface.hpp"

namespace partuv::detail {

/// Unit normals averaged with their neighbours', the less the more they differ, so that noise goes
/// and creases stay (bilateral normal filter; Zheng, Fu, Au and Tai 2011). `noise` as from
/// `estimate_noise`: the more, the steeper an edge must be to stay.
std::vector<Vec3> filtered_normals(const Surface& surface, double noise, const Context& context);

/// The angle (rad) between filtered normals from which an edge counts as a crease.
double crease_angle(double noise);

}  // namespace partuv::detail
