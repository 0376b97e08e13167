#include "pack/frame.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace partuv::packing {

double rounding_texels(const PackOptions& options, int grid_bits) {
  // Each of two points moves along both axes. The rest covers the arithmetic around it.
  const double steps = 2.0 * options.rounding_steps * std::numbers::sqrt2 * 1.02;
  return steps * std::ldexp(options.resolution, -grid_bits);
}

Frame make_frame(const PackOptions& options, double rounding) {
  const double border =
      options.border_texels < 0.0 ? 0.5 * options.gutter_texels : options.border_texels;
  Frame frame;
  frame.bin.gutter = std::ldexp(options.gutter_texels, options.mip_levels) + rounding;
  frame.inset = std::ldexp(border, options.mip_levels) + rounding;
  if (options.snap_to_texels) {
    frame.bin.gutter += std::numbers::sqrt2;
    frame.inset += 0.5;
  }
  frame.bin.side = options.resolution - 2.0 * frame.inset;
  return frame;
}

bool merely_rounded(const PackOptions& options) { return options.rounding_steps == 0.5; }

int grid_bits(int tiles) {
  constexpr int row = 10;  // tiles 1001 to 1010
  const int across = std::max(std::min(tiles, row), (tiles + row - 1) / row);
  return 24 - std::bit_width(static_cast<unsigned>(across - 1));
}

void snap_to_texels(const std::vector<Outline>& charts, double inset, Layout& layout) {
  for (size_t i = 0; i < charts.size(); ++i) {
    Pose& pose = layout.poses[i];
    const Turn turn(pose.rotation_rad, layout.scale);
    Vec2 low = Vec2::Constant(INFINITY);
    for (const Vec2& corner : charts[i].hull) low = low.cwiseMin(turn(corner));
    low = (low + pose.centre).array() + inset;
    pose.centre += Vec2(low.array().round()) - low;
  }
}

}  // namespace partuv::packing
