#include "partuv/pack.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pack/layout.hpp"
#include "pack/outline.hpp"
#include "pack/tile.hpp"

namespace partuv {

namespace {

using namespace packing;

/// Coordinates are stored at multiples of 2^-24 of the atlas: rounding moves each of two points by
/// up to half a step along both axes. A quarter more covers the arithmetic around it.
double rounding_texels(int resolution) { return 1.25 * std::numbers::sqrt2 * 0x1p-24 * resolution; }

/// Area of all charts over the area of the square around them.
double efficiency(const std::vector<Outline>& charts, const Layout& layout) {
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);
  double area = 0.0;
  for (size_t i = 0; i < charts.size(); ++i) {
    const Turn turn(layout.poses[i].rotation_rad, layout.scale);
    for (const Vec2& corner : charts[i].hull) {
      const Vec2 at = turn(corner) + layout.poses[i].centre;
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    area += charts[i].area * layout.scale * layout.scale;
  }
  const double side = (high - low).maxCoeff();
  return side > 0.0 ? area / (side * side) : 0.0;
}

}  // namespace

Packing pack(const std::vector<PackChart>& charts, const PackOptions& options, Context& context) {
  Packing packing;
  packing.placements.resize(charts.size());
  if (charts.empty()) return packing;
  const Outlines outlines = make_outlines(charts);
  const double rounding = rounding_texels(options.resolution);
  const double border = 0.5 * options.gutter_texels + rounding;
  Bin bin;
  bin.side = options.resolution - 2.0 * border;
  bin.gutter = options.gutter_texels + rounding;
  TilePlan plan;
  plan.cells = std::clamp(options.resolution, 256, 2048);
  plan.effort = options.effort;
  const Layout layout = fill_tile(outlines.charts, bin, plan, context);

  const double texel = 1.0 / options.resolution;
  for (size_t i = 0; i < charts.size(); ++i) {
    const Pose& pose = layout.poses[i];
    Placement& placement = packing.placements[i];
    placement.rotation_rad = pose.rotation_rad;
    placement.scale = layout.scale / outlines.unit * texel;
    placement.offset = (pose.centre.array() + border) * texel;
    placement.offset -= Turn(pose.rotation_rad, placement.scale)(outlines.charts[i].centre);
  }
  packing.efficiency = efficiency(outlines.charts, layout);
  return packing;
}

}  // namespace partuv
