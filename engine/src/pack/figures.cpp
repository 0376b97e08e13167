#include "pack/figures.hpp"

#include <algorithm>
#include <cmath>

#include "pack/distance.hpp"
#include "pack/mask.hpp"

namespace partuv::packing {

TileFigures measure_tile(const std::vector<Outline>& charts, const Layout& layout,
                         const Frame& frame, const PackOptions& options, const WrittenGrid& grid) {
  TileFigures figures;
  figures.charts = static_cast<int32_t>(charts.size());
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);
  double area = 0.0;
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
  }
  const double side = (high - low).maxCoeff();
  if (side > 0.0) figures.efficiency = area / (side * side);
  // Charts further apart than this are not near each other.
  const double reach = std::max(grid.resolution / 16.0, 2.0 * frame.bin.gutter);
  WrittenGrid plain = grid;
  plain.rounded = false;
  std::optional<PlacedSides> written = WrittenOutlines(charts, grid).place(layout, frame.inset);
  const double rounding = grid.rounded && written ? 0.0 : rounding_texels(options, grid.bits);
  if (!written) written = WrittenOutlines(charts, plain).place(layout, frame.inset);
  const double least = least_distance(*written, reach);
  figures.gutter_texels = least < reach ? std::max(0.0, least - rounding) : INFINITY;
  return figures;
}

}  // namespace partuv::packing
