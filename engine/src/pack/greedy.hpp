#pragma once

#include <cstdint>
#include <vector>

#include "pack/layout.hpp"
#include "pack/mask.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// A chart as the raster passes see it.
struct Shape {
  Loops loops;              ///< simplified
  double slack = 0.0;       ///< how far the loops may be off
  double start_rad = 0.0;   ///< the turn to its least rectangle
  double length = 0.0;      ///< of that rectangle
  double square_rad = 0.0;  ///< the turn to its least square
  double bulk = 0.0;        ///< charts are placed by falling bulk
  bool wary = false;        ///< known to get caught where the raster is a little too generous
};

/// One of `count` turns evenly over a full one. They start at the least rectangle, or at the least
/// square where the rectangle is too long for a bin of this side, in outline units.
double turn_rad(const Shape& shape, int turn, int count, double side);

/// The mask of a shape; scale and growth are in cells. A wary shape never gets the benefit of
/// `Cover::centres` and keeps half a cell more distance.
Mask make_mask(const Shape& shape, double rotation_rad, double scale, double growth, Cover cover);

/// Tolerance and gutter are in outline units. Upright shapes turn from their least rectangle only.
std::vector<Shape> make_shapes(const std::vector<Outline>& charts, double tolerance, double gutter,
                               bool upright);

/// The masks of all shapes in all turns at one scale (texels per outline unit).
class MaskSet {
 public:
  /// `cells` along a side of the bin; `rotations` turns, evenly over a full one.
  MaskSet(const std::vector<Shape>& shapes, const Bin& bin, double scale, int cells, int rotations,
          Cover cover, const Context& context);

  const Mask& at(int shape, int turn) const { return masks_[size_t(shape) * rotations_ + turn]; }
  int rotations() const { return rotations_; }
  int cells() const { return cells_; }
  double scale() const { return scale_; }
  /// The pose of a mask with its lower left corner in a cell.
  Pose pose(const Mask& mask, int x, int y) const;
  /// The mask of an outline in a pose.
  PlacedMask placed(const Outline& outline, const Pose& pose) const;

 private:
  double scale_, cell_, gutter_, growth_;
  int cells_, rotations_;
  std::vector<Mask> masks_;
};

/// Place the shapes one by one, each as low as it goes and then as far left. Variant 0 takes the
/// largest first; every other variant shuffles a little in its own way. Returns a layout of scale 0
/// when they do not all fit or the context stops. With `Cover::touched` the gutter holds by
/// construction.
Layout greedy(const std::vector<Shape>& shapes, const MaskSet& masks, uint64_t variant,
              const Context& context);

/// The same in a strip of the bin, `width` cells wide.
Layout greedy_strip(const std::vector<Shape>& shapes, const MaskSet& masks, int width,
                    const Context& context);

/// The same around charts that are placed already, at the scale of the masks.
Layout greedy_around(const std::vector<Outline>& placed, const Layout& layout,
                     const std::vector<Shape>& shapes, const MaskSet& masks,
                     const Context& context);

}  // namespace partuv::packing
