#pragma once

#include <vector>

#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

constexpr size_t searched_charts = 250;  // more are packed by raster passes alone

struct TilePlan {
  int cells = 1024;      ///< along a side of the raster, for thousands of charts
  int rotations = 4;     ///< turns tried in the first raster pass; later ones try twice as many
  bool upright = false;  ///< only quarter turns from the least rectangle
  double effort = 1.0;   ///< scales the work of the search; 0 leaves it out
};

/// Fill one square with charts at the largest scale found. Always gives a layout: with `shelves`
/// alone when the context stops, at a smaller gutter only if not even points fit the bin.
Layout fill_tile(const std::vector<Outline>& charts, const Bin& bin, const TilePlan& plan,
                 const Context& context);

/// The charts of a filled tile at a smaller scale, each about where it was. Scale 0 when that is
/// not found.
Layout lowered(const std::vector<Outline>& charts, const Bin& bin, const TilePlan& plan,
               const Layout& layout, double scale, const Context& context);

}  // namespace partuv::packing
