#include "partuv/pack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pack/distance.hpp"
#include "pack/greedy.hpp"
#include "pack/layout.hpp"
#include "pack/orient.hpp"
#include "pack/outline.hpp"

namespace partuv {

namespace {

using namespace packing;

/// Coordinates are stored at multiples of 2^-24 of the atlas: rounding moves each of two points by
/// up to half a step along both axes. A quarter more covers the arithmetic around it.
double rounding_texels(int resolution) { return 1.25 * std::numbers::sqrt2 * 0x1p-24 * resolution; }

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

/// Greedy passes at scales that close in on the largest one that works.
void search_scale(const std::vector<Outline>& charts, const Bin& bin, const GreedyPlan& plan,
                  Layout& best, const Context& context) {
  constexpr double finest = 1.002;
  double low = best.scale;
  double high = INFINITY;
  double trial = std::max(low * finest, scale_of_share(charts, bin, 0.7));
  double factor = 1.1;
  while (!context.stopping() && low * finest <= high) {
    Layout layout = greedy(charts, bin, trial, plan, context);
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

/// Scale the charts, each about its centre, by the largest factor that keeps gutter and bin.
void inflate(const std::vector<Outline>& charts, const Bin& bin, Layout& layout,
             const Context& context) {
  double largest = 0.0;
  for (const Outline& chart : charts) largest = std::max(largest, chart.radius);
  const double most = std::max(0.5 * bin.gutter, 0.25) / std::max(1e-9, largest * layout.scale);
  auto valid = [&](double growth) {
    const PlacedSegments placed = place_segments(charts, layout, growth);
    for (const Segment& segment : placed.segments) {
      const double low = std::min(segment.a.minCoeff(), segment.b.minCoeff());
      const double high = std::max(segment.a.maxCoeff(), segment.b.maxCoeff());
      if (low < 0.0 || high > bin.side) return false;
    }
    return least_distance(placed, bin.gutter + 1e-9) >= bin.gutter;
  };
  double good = 1.0;
  double bad = 1.0 + most;
  for (int i = 0; i < 12 && !context.stopping(); ++i) {
    const double middle = 0.5 * (good + bad);
    (valid(middle) ? good : bad) = middle;
  }
  layout.scale *= good;
}

}  // namespace

Packing pack(const std::vector<PackChart>& charts, const PackOptions& options, Context& context) {
  Packing packing;
  packing.placements.resize(charts.size());
  if (charts.empty()) return packing;
  const Outlines outlines = make_outlines(charts);
  const std::vector<Outline>& list = outlines.charts;
  const double rounding = rounding_texels(options.resolution);
  const double border = 0.5 * options.gutter_texels + rounding;
  Bin bin;
  bin.side = options.resolution - 2.0 * border;
  bin.gutter = options.gutter_texels + rounding;

  Layout best = shelves(list, bin);
  while (best.scale <= 0.0) {  // not even points fit: ask for less
    bin.gutter *= 0.5;
    best = shelves(list, bin);
  }
  bool any_area = false;
  for (const Outline& chart : list) any_area |= chart.radius > 0.0;
  if (any_area) {
    GreedyPlan plan;
    plan.cells = list.size() <= 100 ? 512 : options.resolution;
    search_scale(list, bin, plan, best, context);
  }
  inflate(list, bin, best, context);

  const double texel = 1.0 / options.resolution;
  const double scale = best.scale / outlines.unit * texel;
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);
  double area = 0.0;
  for (size_t i = 0; i < list.size(); ++i) {
    const Pose& pose = best.poses[i];
    Placement& placement = packing.placements[i];
    placement.rotation_rad = pose.rotation_rad;
    placement.scale = scale;
    placement.offset = (pose.centre.array() + border) * texel;
    placement.offset -= Turn(pose.rotation_rad, scale)(list[i].centre);
    const Turn turn(pose.rotation_rad, best.scale);
    for (const Vec2& corner : list[i].hull) {
      const Vec2 at = turn(corner) + pose.centre;
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    area += list[i].area;
  }
  const double side = (high - low).maxCoeff();
  if (side > 0.0) packing.efficiency = area * best.scale * best.scale / (side * side);
  return packing;
}

}  // namespace partuv
