#pragma once

#include <span>

#include "partuv/tree.hpp"

namespace partuv {

/// Ward's clustering of per-face features, constrained to adjacent regions and weighted by face
/// area: the adjacent pair with the least area(A) area(B) / (area(A) + area(B)) |mean(A) -
/// mean(B)|^2 is merged first; equal costs go to the smaller nodes.
///
/// features: F x `dimensions`, row by row, finite. Component first, deadline and `face_areas` as
/// for `build_nbm_tree`; a cancelled call fails. O(F log F) distances:
/// a region with hundreds of neighbours is compared anew with all of them only as it grows.
Result<PartTree> build_ward_tree(const Surface& surface, std::span<const float> features,
                                 int dimensions, const Context& context,
                                 std::span<const double> face_areas = {});
Result<PartTree> build_ward_tree(const Surface& surface, std::span<const double> features,
                                 int dimensions, const Context& context,
                                 std::span<const double> face_areas = {});

}  // namespace partuv
