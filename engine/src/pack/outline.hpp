#pragma once

#include <vector>

#include "partuv/pack.hpp"
#include "partuv/types.hpp"

namespace partuv::packing {

struct Segment {
  Vec2 a;
  Vec2 b;
};

/// What the packer knows of a chart: its boundary, around `centre`, divided by a common unit.
struct Outline {
  Vec2 centre = Vec2::Zero();     ///< middle of the chart's bounding box, in the caller's units
  std::vector<Segment> segments;  ///< boundary, the inside on the left; holes included
  std::vector<Vec2> hull;         ///< convex hull, counter-clockwise, no collinear points
  double area = 0.0;              ///< sum of the triangles' absolute areas
  double perimeter = 0.0;
  double radius = 0.0;  ///< of the disk around `centre` that holds the chart
};

struct Outlines {
  double unit = 1.0;  ///< caller's units per unit here: the largest radius
  std::vector<Outline> charts;
};

/// The boundary of every chart. Edges used once by the triangles are the boundary; a chart with a
/// triangle that is not counter-clockwise has none to trust, so all its edges count.
Outlines make_outlines(const std::vector<PackChart>& charts);

/// Convex hull, counter-clockwise without collinear points (Andrew's monotone chain).
std::vector<Vec2> convex_hull(std::vector<Vec2> points);

}  // namespace partuv::packing
