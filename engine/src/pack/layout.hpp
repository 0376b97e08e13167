#pragma once

#include <vector>

#include "pack/outline.hpp"
#include "partuv/types.hpp"

namespace partuv::packing {

/// The square to fill, in texels. The border is already taken off.
struct Bin {
  double side = 0.0;
  double gutter = 0.0;  ///< least distance between two outlines
  double wall = 0.0;    ///< least distance from the edge of the square
};

struct Pose {
  double rotation_rad = 0.0;
  Vec2 centre = Vec2::Zero();  ///< where the outline's centre lies, texels
};

/// A place for every chart at a common scale.
struct Layout {
  double scale = 0.0;  ///< texels per outline unit; 0: no layout
  std::vector<Pose> poses;
};

/// A linear map from outline units to texels.
struct Turn {
  double cosine = 1.0;
  double sine = 0.0;

  Turn(double rotation_rad, double scale);
  Vec2 operator()(const Vec2& p) const {
    return Vec2(cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y());
  }
};

/// Boxes on shelves: valid for any charts and any count as long as points at gutter distance fit
/// the bin. O(N log N), no raster, so it is the fallback behind everything else. Charts stand on
/// their least rectangle. Scale 0 when even points do not fit.
Layout shelves(const std::vector<Outline>& charts, const Bin& bin);

}  // namespace partuv::packing
