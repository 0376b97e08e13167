#include "pack/written.hpp"

#include <cmath>
#include <limits>

namespace partuv::packing {

double WrittenGrid::step_texels() const { return std::ldexp(resolution, -bits); }

WrittenOutlines::WrittenOutlines(const std::vector<Outline>& charts, const WrittenGrid& grid)
    : grid_(grid) {
  for (const Outline& chart : charts) {
    loops_.push_back(chart.loops);
    away_.push_back(chart.away);
  }
}

std::optional<PlacedSides> WrittenOutlines::place(const Layout& layout, double inset) const {
  // A point takes about a dozen operations, each of them off by half of this at most.
  constexpr double arithmetic = 16.0 * std::numeric_limits<double>::epsilon();
  const double step = grid_.step_texels();
  PlacedSides placed = place_sides(loops_, layout);
  if (!grid_.rounded) {
    for (Segment& side : placed.sides) {
      side.a.array() += inset;
      side.b.array() += inset;
    }
    return placed;
  }
  for (size_t i = 0; i < placed.sides.size(); ++i) {
    const double reach = away_[placed.chart[i]] * layout.scale + grid_.resolution;
    const double clear = 0.5 - arithmetic * reach / step;
    for (Vec2* point : {&placed.sides[i].a, &placed.sides[i].b}) {
      for (int k = 0; k < 2; ++k) {
        const double at = ((*point)[k] + inset) / step;
        const double rounded = std::round(at);
        if (!(std::abs(at - rounded) < clear)) return std::nullopt;
        (*point)[k] = rounded * step;
      }
    }
  }
  return placed;
}

bool WrittenOutlines::hold(const Layout& layout, const Frame& frame) const {
  constexpr double arithmetic_texels = 1e-9;  // of whoever measures the distances
  const std::optional<PlacedSides> placed = place(layout, frame.inset);
  if (!placed) return false;
  const double high = grid_.resolution - frame.inset;
  for (const Segment& side : placed->sides) {
    if (side.a.minCoeff() < frame.inset || side.a.maxCoeff() > high) return false;
  }
  const double least = frame.bin.gutter + arithmetic_texels;
  return least_distance(*placed, least) >= least;
}

}  // namespace partuv::packing
