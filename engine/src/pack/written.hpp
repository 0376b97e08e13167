#pragma once

#include <optional>
#include <vector>

#include "pack/distance.hpp"
#include "pack/frame.hpp"
#include "pack/layout.hpp"

namespace partuv::packing {

/// What coordinates are rounded to when they are written.
struct WrittenGrid {
  int resolution = 1024;
  int bits = 24;        ///< steps of 2^-bits of a tile's side
  bool rounded = true;  ///< if not, points are taken as they are, and distances leave room for it

  double step_texels() const;
};

/// Outlines as they are once every point is written.
class WrittenOutlines {
 public:
  WrittenOutlines(const std::vector<Outline>& charts, const WrittenGrid& grid);

  /// All sides in texels of the tile, for a layout in a bin that lies `inset` from its edges. None
  /// where a point is so near the middle of two steps that the writer's arithmetic decides.
  std::optional<PlacedSides> place(const Layout& layout, double inset) const;

  /// Whether gutter and border of a frame hold for a layout in its bin.
  bool hold(const Layout& layout, const Frame& frame) const;

 private:
  WrittenGrid grid_;
  std::vector<Loops> loops_;
  std::vector<double> away_;  // of the charts' centres from the caller's origin, unscaled
};

}  // namespace partuv::packing
