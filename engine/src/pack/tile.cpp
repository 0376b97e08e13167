#include "pack/tile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pack/dust.hpp"
#include "pack/greedy.hpp"
#include "pack/orient.hpp"
#include "pack/polish.hpp"
#include "pack/search.hpp"

namespace partuv::packing {

namespace {

/// The scale at which the outlines, each grown by half the gutter, have a given share of the bin's
/// area (as if growing never closed a hole); 0 when the gutters alone have more.
double scale_of_share(const std::vector<Outline>& charts, const Bin& bin, double share) {
  double area = 0.0;
  double perimeter = 0.0;
  for (const Outline& chart : charts) {
    area += chart.area;
    perimeter += chart.perimeter;
  }
  const double r = 0.5 * bin.gutter;
  const double room = share * (bin.side + bin.gutter) * (bin.side + bin.gutter) -
                      std::numbers::pi * r * r * static_cast<double>(charts.size());
  if (room <= 0.0) return 0.0;
  const double half = 0.5 * perimeter * r;
  const double root = half + std::sqrt(half * half + area * room);
  return root > 0.0 ? room / root : 0.0;
}

/// Greedy passes at scales that close in on the largest one that works: more nearly where no search
/// follows.
void search_scale(const std::vector<Outline>& charts, const std::vector<Shape>& shapes,
                  const Bin& bin, int cells, int rotations, Layout& best, const Context& context) {
  const double finest = charts.size() <= searched_charts ? 1.012 : 1.002;
  double low = best.scale;
  double high = INFINITY;
  double trial = std::max(low * finest, scale_of_share(charts, bin, 0.7));
  double factor = 1.1;
  while (!context.stopping() && low * finest <= high) {
    const MaskSet masks(shapes, bin, trial, cells, rotations, Cover::touched, context);
    Layout layout = greedy(shapes, masks, 0, context);
    if (layout.scale > 0.0) {
      best = std::move(layout);
      low = trial;
    } else {
      high = trial;
    }
    if (std::isinf(high)) {
      trial = low * factor;
    } else if (low * factor < high) {
      trial = high / factor;
      factor *= factor;
    } else {
      trial = std::sqrt(low * high);
    }
  }
}

/// A chart alone lies best in its least square.
Layout single(const Outline& chart, const Bin& bin) {
  const Orientation turn = least_square(chart.hull);
  const double extent = turn.size.maxCoeff();
  Layout layout;
  layout.scale = extent > 0.0 ? bin.side / extent : bin.side;
  const Turn map(turn.rotation_rad, layout.scale);
  Vec2 low = Vec2::Constant(INFINITY);
  for (const Vec2& corner : chart.hull) low = low.cwiseMin(map(corner));
  layout.poses = {{turn.rotation_rad, -low}};
  return layout;
}

}  // namespace

Layout fill_tile(const std::vector<Outline>& charts, const Bin& bin, const TilePlan& plan,
                 const Context& context) {
  constexpr size_t many = 4000;       // beyond them the raster result stays as it is
  constexpr size_t programs = 40000;  // linear programs times charts
  if (charts.size() == 1 && !plan.upright) return single(charts.front(), bin);
  Bin room = bin;
  Layout best = shelves(charts, room);
  while (best.scale <= 0.0) {  // not even points fit: ask for less
    room.gutter *= 0.5;
    best = shelves(charts, room);
  }
  bool any_area = false;
  for (const Outline& chart : charts) any_area |= chart.radius > 0.0;
  if (!any_area) return best;
  const bool searched = charts.size() <= searched_charts && plan.effort > 0.0;
  const int cells = charts.size() <= searched_charts ? 512 : plan.cells;
  const double guess = std::max(best.scale, scale_of_share(charts, room, 0.6));
  const double cell = room.side / cells;
  const std::vector<Shape> shapes =
      make_shapes(charts, 0.05 * cell / guess, room.gutter / guess, plan.upright);
  search_scale(charts, shapes, room, cells, plan.rotations, best, context);
  if (charts.size() > searched_charts &&
      !plan.upright) {  // no search follows: more turns may make up for it
    search_scale(charts, shapes, room, cells, 2 * plan.rotations, best, context);
  }
  const Polisher polisher(charts, room, guess, plan.upright);
  const int steps = static_cast<int>(std::min<size_t>(40, programs / charts.size()));
  auto tighten = [&](Layout& layout) {
    Layout tight = layout;
    polisher.tighten(tight, steps, Caught::fail, context);
    if (tight.scale > layout.scale) layout = std::move(tight);
  };
  Layout around;
  if (charts.size() > searched_charts && !plan.upright && plan.effort > 0.0) {
    around = fill_around_large(charts, room, plan, best.scale, context);
  }
  if (charts.size() <= many && !searched) {
    tighten(best);
    if (around.scale > 0.0) tighten(around);
  }
  if (around.scale > best.scale) best = std::move(around);
  if (searched) {
    best = search(charts, room, polisher, best, plan, context);
    tighten(best);
  }
  polisher.settle(best, context);
  if (best.scale > 0.0 && charts.size() <= many) polisher.close_up(best, context);
  if (best.scale > 0.0) return best;
  // Boxes on shelves shrink towards their centres without meeting.
  best = shelves(charts, room);
  polisher.settle(best, context);
  return best;
}

Layout lowered(const std::vector<Outline>& charts, const Bin& bin, const TilePlan& plan,
               const Layout& layout, double scale, const Context& context) {
  if (layout.scale <= scale) return layout;
  Layout result = Polisher(charts, bin, scale, plan.upright).shrunk(layout, scale, context);
  if (result.scale > 0.0) return result;
  result = shelves(charts, bin);
  if (result.scale < scale) return {};
  result.scale = scale;  // boxes on shelves shrink towards their centres without meeting
  return result;
}

}  // namespace partuv::packing
