#include "pack/polish.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pack/distance.hpp"

namespace partuv::packing {

namespace {

constexpr double detail = 5e-5;  // of the bin: the simplified loops may be off by this much

}  // namespace

Polisher::Polisher(const std::vector<Outline>& charts, const Bin& bin, double scale, bool upright)
    : upright_(upright),
      bin_(bin),
      tight_{bin.side, bin.gutter + 2.0 * detail * bin.side, detail * bin.side} {
  for (const Outline& chart : charts) {
    radius_ = std::max(radius_, chart.radius);
    exact_.push_back(chart.loops);
    fine_.push_back(reduced(chart, detail * bin.side / scale, bin.gutter / scale));
  }
}

bool Polisher::holds(const std::vector<Loops>& loops, const Bin& bin, const Layout& layout) const {
  const PlacedSides placed = place_sides(loops, layout);
  for (const Segment& side : placed.sides) {
    if (side.a.minCoeff() < bin.wall || side.a.maxCoeff() > bin.side - bin.wall) return false;
  }
  return least_distance(placed, bin.gutter + 1e-9) >= bin.gutter;
}

Pushed Polisher::tighten(Layout& layout, int steps, const Context& context) const {
  constexpr double shrink = 0.99;
  constexpr int most_shrinks = 4;
  const int push_steps = std::min(12, steps);
  Pushed total;
  if (layout.scale <= 0.0) return total;
  Layout start = layout;
  layout.scale = 0.0;
  for (int i = 0; i < most_shrinks && !context.stopping(); ++i, start.scale *= shrink) {
    const PlacedSides placed = place_sides(fine_, start);
    if (least_distance(placed, tight_.gutter) < 0.1 * tight_.gutter) continue;
    Pushed pushed = push_apart(fine_, tight_, upright_, push_steps, start, context);
    total.work += pushed.work;
    total.caught = std::move(pushed.caught);
    if (!total.caught.empty()) continue;
    total.work += compact(fine_, tight_, upright_, steps, start, context);
    layout = std::move(start);
    break;
  }
  return total;
}

void Polisher::settle(Layout& layout, const Context& context) const {
  const double start = layout.scale;
  const double most = std::max(0.25 * bin_.gutter, 0.25) / std::max(1e-9, radius_ * start);
  double low = 0.0;
  double high = start * (1.0 + most);
  for (double share : {1.0, 0.9999, 0.999, 0.99, 0.97}) {
    layout.scale = share * start;
    if (holds(exact_, bin_, layout)) {
      low = layout.scale;
      break;
    }
    high = layout.scale;
  }
  if (low > 0.0) {
    constexpr int halvings = 8;
    for (int i = 0; i < halvings && !context.stopping(); ++i) {
      layout.scale = 0.5 * (low + high);
      (holds(exact_, bin_, layout) ? low : high) = layout.scale;
    }
  }
  layout.scale = low;
}

Layout Polisher::shrunk(Layout layout, double scale, const Context& context) const {
  constexpr int push_steps = 12;
  layout.scale = scale;
  if (holds(exact_, bin_, layout)) return layout;
  push_apart(fine_, tight_, upright_, push_steps, layout, context);
  if (!holds(exact_, bin_, layout)) layout.scale = 0.0;
  return layout;
}

}  // namespace partuv::packing
