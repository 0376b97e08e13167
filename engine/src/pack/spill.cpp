#include "pack/spill.hpp"

#include <algorithm>
#include <memory>
#include <numbers>
#include <numeric>

#include "pack/board.hpp"
#include "pack/greedy.hpp"
#include "pack/orient.hpp"
#include "partuv/pack.hpp"

namespace partuv::packing {

namespace {

struct Best {
  const Mask* mask = nullptr;
  Board::Spot spot;
};

/// The lowest place on a board over all turns.
Best lowest(Board& board, const MaskSet& masks, int shape) {
  Best best;
  int best_top = 0;
  for (int turn = 0; turn < masks.rotations(); ++turn) {
    const Mask& mask = masks.at(shape, turn);
    const int to = best.mask ? best_top - mask.height + 1 : masks.cells();
    const Board::Spot spot = board.lowest(mask, 0, to);
    if (!spot.found) continue;
    const int top = spot.y + mask.height;
    if (!best.mask || top < best_top || (top == best_top && spot.x < best.spot.x)) {
      best = {&mask, spot};
      best_top = top;
    }
  }
  return best;
}

/// Whether charts are small enough for it to be worth a try.
bool may_fit(const std::vector<Outline>& charts, const Bin& bin, double scale) {
  double area = 0.0;
  for (const Outline& chart : charts) {
    const Vec2 size = scale * least_rectangle(chart.hull).size;
    if (size.x() > std::numbers::sqrt2 * bin.side || size.y() > bin.side) return false;
    area += chart.area * scale * scale;
  }
  return area <= most_tiles * bin.side * bin.side;
}

}  // namespace

Spill spill(const std::vector<Outline>& charts, const Bin& bin, const TilePlan& plan, double scale,
            const Context& context) {
  Spill result;
  result.layout.poses.resize(charts.size());
  result.tile.assign(charts.size(), 0);
  if (!may_fit(charts, bin, scale)) return result;
  const double cell = bin.side / plan.cells;
  const std::vector<Shape> shapes =
      make_shapes(charts, 0.05 * cell / scale, bin.gutter / scale, plan.upright);
  // Of the context only its threads matter here.
  const Context patient(context.threads());
  const MaskSet masks(shapes, bin, scale, plan.cells, plan.rotations, Cover::touched, patient);
  std::vector<int> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return shapes[a].bulk > shapes[b].bulk; });
  std::vector<std::unique_ptr<Board>> boards;
  for (int index : order) {
    if (context.cancelled()) return result;
    Best best;
    size_t tile = 0;
    for (; tile < boards.size() && !best.mask; tile += best.mask ? 0 : 1) {
      best = lowest(*boards[tile], masks, index);
    }
    if (!best.mask) {
      if (boards.size() == static_cast<size_t>(most_tiles)) return result;
      boards.push_back(std::make_unique<Board>(plan.cells));
      best = lowest(*boards.back(), masks, index);
      if (!best.mask) return result;
    }
    boards[tile]->put(*best.mask, best.spot.x, best.spot.y);
    result.layout.poses[index] = masks.pose(*best.mask, best.spot.x, best.spot.y);
    result.tile[index] = static_cast<int32_t>(tile);
  }
  result.layout.scale = scale;
  result.fits = true;
  return result;
}

}  // namespace partuv::packing
