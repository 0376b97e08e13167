#pragma once

#include <array>
#include <optional>

#include "partuv/flatten.hpp"

namespace partuv {

/// Side of the least square that a map fits into, in any turn.
double least_square_side(const std::vector<Vec2>& uv);

/// The two sides of a map cut in two along one short seam, where the larger of their least squares
/// is smallest. Both lie as they lay. None where no cut gives two connected sides that keep the
/// bounds and fit into smaller squares. O(n log n) in the vertices.
std::optional<std::array<Flattening, 2>> cut_across(const Flattening& flattening,
                                                    const FlattenOptions& options);

}  // namespace partuv
