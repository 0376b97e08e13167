#include "pack/figures.hpp"

#include <algorithm>
#include <cmath>

#include "pack/distance.hpp"
#include "pack/mask.hpp"

namespace partuv::packing {

TileFigures measure_tile(const std::vector<Outline>& charts, const Layout& layout,
                         const Frame& frame, double rounding, int resolution) {
  TileFigures figures;
  figures.charts = static_cast<int32_t>(charts.size());
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);
  double area = 0.0;
  std::vector<Loops> loops;
  for (size_t i = 0; i < charts.size(); ++i) {
    const Pose& pose = layout.poses[i];
    const Turn turn(pose.rotation_rad, layout.scale);
    for (const Vec2& corner : charts[i].hull) {
      const Vec2 at = turn(corner) + pose.centre;
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    area += charts[i].area * layout.scale * layout.scale;
    const Vec2 centre = pose.centre.array() + frame.inset;
    const PlacedMask placed = make_placed_mask(charts[i].loops, pose.rotation_rad, centre,
                                               layout.scale, 0.0, Cover::centres);
    for (const Run& run : placed.mask.runs) figures.covered_texels += run.end - run.begin;
    loops.push_back(charts[i].loops);
  }
  const double side = (high - low).maxCoeff();
  if (side > 0.0) figures.efficiency = area / (side * side);
  // Charts further apart than this are not near each other.
  const double reach = std::max(resolution / 16.0, 2.0 * frame.bin.gutter);
  const double least = least_distance(place_sides(loops, layout), reach);
  figures.gutter_texels = least < reach ? std::max(0.0, least - rounding) : INFINITY;
  return figures;
}

}  // namespace partuv::packing
