#pragma once

#include <vector>

#include "partuv/piece.hpp"

namespace partuv {

/// Round a placed flattening (in the unit square) to the 2^-grid_bits grid on which a coordinate
/// and its flip are both exact in single precision. Needles thinner than the grid may collapse or
/// turn over by rounding: their vertices then take the neighbouring grid points that keep the areas
/// best.
std::vector<Vec2> round_to_grid(const Piece& piece, const std::vector<Vec2>& uv, double least_area,
                                int grid_bits = 24);

}  // namespace partuv
