#include "pack/polish.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pack/distance.hpp"
#include "pack/greedy.hpp"

namespace partuv::packing {

namespace {

// Of the bin's side: the simplified loops may be off by this much.
constexpr double detail = 5e-5;
constexpr double last_detail = 1e-6;
// How far charts may move in one program, of the bin's side.
constexpr double trust = 0.002;
constexpr double last_trust = 2.0 * detail;

constexpr int push_steps = 12;

Bin with_room(const Bin& bin, double share) {
  return {bin.side, bin.gutter + 2.0 * share * bin.side, share * bin.side};
}

}  // namespace

Polisher::Polisher(const std::vector<Outline>& charts, const Bin& bin, double scale, bool upright)
    : charts_(charts),
      upright_(upright),
      bin_(bin),
      tight_(with_room(bin, detail)),
      tighter_(with_room(bin, last_detail)) {
  for (const Outline& chart : charts) {
    radius_ = std::max(radius_, chart.radius);
    exact_.push_back(chart.loops);
    finest_.push_back(reduced(chart, last_detail * bin.side / scale, bin.gutter / scale));
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

Pushed Polisher::tighten(Layout& layout, int steps, Caught caught, const Context& context) const {
  constexpr double shrink = 0.99;
  constexpr int most_shrinks = 4;
  Pushed total;
  if (layout.scale <= 0.0) return total;
  Layout start = layout;
  layout.scale = 0.0;
  for (int i = 0; i < most_shrinks && !context.stopping(); ++i, start.scale *= shrink) {
    const PlacedSides placed = place_sides(fine_, start);
    if (least_distance(placed, tight_.gutter) < 0.1 * tight_.gutter) continue;
    Pushed pushed = push_apart(fine_, tight_, upright_, std::min(push_steps, steps),
                               trust * bin_.side, start, context);
    total.work += pushed.work;
    total.caught = std::move(pushed.caught);
    if (!total.caught.empty()) {
      if (caught == Caught::fail || total.caught.size() > few()) continue;
      const Freed freed = free_without(total.caught, start, context);
      total.work += freed.work;
      // Otherwise they seldom come free in smaller steps, either.
      if (!freed.done || !put_elsewhere(freed, start, context)) break;
      total.caught.clear();
    }
    total.work += compact(fine_, tight_, upright_, steps, trust * bin_.side, start, context);
    layout = std::move(start);
    break;
  }
  return total;
}

/// Pushes the charts apart without some of them; those that are caught then are taken out, too, as
/// long as they are few.
Polisher::Freed Polisher::free_without(std::vector<int> out, const Layout& layout,
                                       const Context& context) const {
  constexpr int rounds = 3;
  Freed freed{std::move(out), {}, {layout.scale, layout.poses}, false, 0};
  std::vector<Pose> poses = layout.poses;
  for (int round = 0; round < rounds && !context.stopping(); ++round) {
    if (freed.out.size() > few()) break;
    freed.rest.clear();
    freed.layout.poses.clear();
    std::vector<Loops> loops;
    for (int i = 0; i < static_cast<int>(charts_.size()); ++i) {
      if (std::binary_search(freed.out.begin(), freed.out.end(), i)) continue;
      freed.rest.push_back(i);
      freed.layout.poses.push_back(poses[i]);
      loops.push_back(fine_[i]);
    }
    const Pushed pushed =
        push_apart(loops, tight_, upright_, push_steps, trust * bin_.side, freed.layout, context);
    freed.work += pushed.work;
    freed.done = pushed.caught.empty();
    if (freed.done) break;
    for (size_t i = 0; i < freed.rest.size(); ++i) poses[freed.rest[i]] = freed.layout.poses[i];
    for (const int chart : pushed.caught) freed.out.push_back(freed.rest[chart]);
    std::sort(freed.out.begin(), freed.out.end());
  }
  return freed;
}

/// Puts the charts that were taken out into the room that the rest leaves. Returns whether all are
/// in the layout.
bool Polisher::put_elsewhere(const Freed& freed, Layout& layout, const Context& context) const {
  constexpr int cells = 512;
  const int rotations = upright_ ? 4 : 16;
  auto chosen = [&](const std::vector<int>& which) {
    std::vector<Outline> outlines;
    for (const int chart : which) outlines.push_back(charts_[chart]);
    return outlines;
  };
  const double scale = freed.layout.scale;
  const double cell = (tight_.side + tight_.gutter) / cells;
  const std::vector<Shape> shapes =
      make_shapes(chosen(freed.out), 0.05 * cell / scale, tight_.gutter / scale, upright_);
  const MaskSet masks(shapes, tight_, scale, cells, rotations, Cover::touched, context);
  const Layout between = greedy_around(chosen(freed.rest), freed.layout, shapes, masks, context);
  if (between.scale <= 0.0) return false;
  layout = between;
  layout.poses.resize(charts_.size());
  for (size_t i = 0; i < freed.rest.size(); ++i) {
    layout.poses[freed.rest[i]] = freed.layout.poses[i];
  }
  for (size_t i = 0; i < freed.out.size(); ++i) layout.poses[freed.out[i]] = between.poses[i];
  return true;
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

void Polisher::close_up(Layout& layout, const Context& context) const {
  constexpr int steps = 20;
  Layout closer = layout;
  compact(finest_, tighter_, upright_, steps, last_trust * bin_.side, closer, context);
  settle(closer, context);
  if (closer.scale > layout.scale) layout = std::move(closer);
}

Layout Polisher::shrunk(Layout layout, double scale, const Context& context) const {
  layout.scale = scale;
  if (holds(exact_, bin_, layout)) return layout;
  push_apart(fine_, tight_, upright_, push_steps, trust * bin_.side, layout, context);
  if (!holds(exact_, bin_, layout)) layout.scale = 0.0;
  return layout;
}

}  // namespace partuv::packing
