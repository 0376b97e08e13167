#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/error.hpp"
#include "partuv/types.hpp"

namespace partuv {

/// One flattened chart to be placed. Its own coordinates keep the 3D scale: all charts share one
/// unit, so that one factor for all of them gives a uniform texel density.
struct PackChart {
  std::vector<Vec2> uv;             ///< points
  std::vector<Triangle> triangles;  ///< all of one winding, indices into `uv`
  int32_t part = 0;                 ///< the part it belongs to
  int32_t rank = 0;                 ///< where its part comes in the order of the part tree
  double weight = 1.0;              ///< its texel density, relative to other charts
};

/// How charts of one part lie to each other.
enum class Grouping {
  none,    ///< wherever they fit best
  near,    ///< together, where that costs little density
  strict,  ///< in an upright rectangle that no other part enters
};

struct PackOptions {
  int resolution = 1024;        ///< texels along a side of a tile
  double gutter_texels = 4.0;   ///< least distance between two charts
  double border_texels = -1.0;  ///< least distance to a tile's edge; below 0: half the gutter
  int mip_levels = 0;           ///< halvings of the texture that gutter and border survive
  bool snap_to_texels = false;  ///< charts' lower left corners lie on corners of texels
  int rotations = 4;            ///< turns tried in the first passes
  double texel_density = 0.0;   ///< texels per unit; 0: as many as fit
  Grouping group_by_part = Grouping::none;
  int tiles = 1;        ///< tiles to spread the parts over; 0: one for each part
  double effort = 1.0;  ///< scales the work spent on density; 0 is one quick pass
  /// How far writing may move a point from its place, along an axis, in steps of the grid: half a
  /// step for rounding, two more where a needle would collapse (`round_to_grid`).
  double rounding_steps = 2.5;
};

constexpr int most_tiles = 100;

/// Where a chart went: point of its tile = scale * R(rotation_rad) * uv + offset, in the unit
/// square.
struct Placement {
  double rotation_rad = 0.0;
  double scale = 1.0;
  Vec2 offset = Vec2::Zero();
  int32_t tile = 0;
};

struct TileFigures {
  int32_t charts = 0;
  double efficiency = 0.0;      ///< area of its charts over the area of the square around them
  double covered_texels = 0.0;  ///< texels whose centre lies in a chart
  double gutter_texels = 0.0;   ///< least distance of two charts, or infinite where none is near
  double seconds = 0.0;         ///< wall time
};

struct Packing {
  std::vector<Placement> placements;  ///< one per chart
  std::vector<TileFigures> tiles;
  double efficiency = 0.0;  ///< mean over the tiles
  int grid_bits = 24;       ///< the guarantees hold for coordinates rounded to 2^-grid_bits
};

/// Whether options fit each other and the charts' number; else the name of the first that does not.
Result<bool> check_pack_options(const PackOptions& options);

/// Place charts in one or several unit squares at one common scale (apart from their weights), as
/// large as it finds. Deterministic for any number of threads. Gutter and border hold exactly on
/// the outlines, with room for rounding the result to the grid. When the context stops early, the
/// result is valid but less dense. Fails on options that do not fit, and where a fixed texel
/// density needs more than `most_tiles`.
Result<Packing> pack(const std::vector<PackChart>& charts, const PackOptions& options,
                     const Context& context);

}  // namespace partuv
