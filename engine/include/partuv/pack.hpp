#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/types.hpp"

namespace partuv {

/// One flattened chart to be placed. Its own coordinates keep the 3D scale: all charts share one
/// unit, so that one factor for all of them gives a uniform texel density.
struct PackChart {
  std::vector<Vec2> uv;             ///< points
  std::vector<Triangle> triangles;  ///< counter-clockwise, indices into `uv`
  int32_t part = 0;                 ///< the part it belongs to
};

struct PackOptions {
  int resolution = 1024;       ///< texels along a side of the atlas
  double gutter_texels = 4.0;  ///< least distance between two charts, in texels at `resolution`
  double effort = 1.0;         ///< scales the work spent on density; 0 is one quick pass
};

/// Where a chart went: atlas point = scale * R(rotation_rad) * uv + offset, in the unit square.
struct Placement {
  double rotation_rad = 0.0;
  double scale = 1.0;
  Vec2 offset = Vec2::Zero();
  int32_t tile = 0;
};

struct Packing {
  std::vector<Placement> placements;  ///< one per chart
  double efficiency = 0.0;            ///< area of all charts over the area of their bounding square
};

/// Place charts in the unit square at one common scale, as large as it finds. Deterministic for any
/// number of threads. The gutter holds exactly on the outlines, with room for rounding the result
/// to the 2^-24 grid.
Packing pack(const std::vector<PackChart>& charts, const PackOptions& options, Context& context);

}  // namespace partuv
