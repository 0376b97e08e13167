#pragma once

#include "pack/layout.hpp"
#include "partuv/pack.hpp"

namespace partuv::packing {

/// What one tile offers, in texels: the bin for outlines, and how far it lies from the edge.
struct Frame {
  double inset = 0.0;
  Bin bin;
};

/// What rounding coordinates to 2^-grid_bits of a tile may take from a distance, in texels.
double rounding_texels(const PackOptions& options, int grid_bits);

/// Gutter and border of the coarsest mip level, with room for snapping and for what rounding may
/// take, in texels.
Frame make_frame(const PackOptions& options, double rounding);

/// Whether what is written of a point is its place rounded to the grid, and nothing else.
bool merely_rounded(const PackOptions& options);

/// Bits of the fraction that single precision keeps where a tile of so many lies, in rows of ten.
int grid_bits(int tiles);

/// Move every chart to the nearest place where the lower left corner of its box is a corner of
/// texels: by up to half a texel along both axes.
void snap_to_texels(const std::vector<Outline>& charts, double inset, Layout& layout);

}  // namespace partuv::packing
