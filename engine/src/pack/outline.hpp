#pragma once

#include <cstdint>
#include <vector>

#include "partuv/pack.hpp"
#include "partuv/types.hpp"

namespace partuv::packing {

struct Segment {
  Vec2 a;
  Vec2 b;
};

/// Closed polygons with the inside on their left: outer loops run counter-clockwise, holes
/// clockwise. A loop may be a single point or a segment there and back.
struct Loops {
  std::vector<Vec2> points;
  std::vector<int32_t> start{0};  ///< offsets into `points`, one more than loops

  int count() const { return static_cast<int>(start.size()) - 1; }
  /// Index of the point behind point i of a loop.
  int32_t next(int loop, int32_t i) const { return i + 1 < start[loop + 1] ? i + 1 : start[loop]; }
  void close();  ///< end the loop that the points behind the last offset form, if there are any

  /// Calls body(a, b) for every side of every loop.
  template <typename Body>
  void for_each_side(Body&& body) const {
    for (int loop = 0; loop < count(); ++loop) {
      for (int32_t i = start[loop]; i < start[loop + 1]; ++i) {
        body(points[i], points[next(loop, i)]);
      }
    }
  }
};

/// What the packer knows of a chart: its boundary, around `centre`, divided by a common unit and
/// times its weight.
struct Outline {
  Vec2 centre = Vec2::Zero();  ///< middle of the chart's bounding box, in the caller's units
  Loops loops;                 ///< never empty
  std::vector<Vec2> hull;      ///< convex hull, counter-clockwise, no collinear points
  double area = 0.0;           ///< sum of the triangles' absolute areas
  double perimeter = 0.0;
  double radius = 0.0;  ///< of the disk around `centre` that holds the chart
  double away = 0.0;    ///< of `centre` from the caller's origin
};

struct Outlines {
  double unit = 1.0;  ///< caller's units per unit here: the largest radius
  std::vector<Outline> charts;
};

/// The boundary of every chart, as sum of its triangles' boundaries. In a chart with triangles of
/// both windings all count as if they had the same, so that none hides another.
Outlines make_outlines(const std::vector<PackChart>& charts, const Context& context);

/// Loops with fewer points, nowhere further than `tolerance` from the given ones (Douglas and
/// Peucker 1973), without holes that are nowhere wider than `least_hole`.
Loops simplified(const Loops& loops, double tolerance, double least_hole);

/// What matters of an outline to charts that keep `gutter` from it: simplified, without holes in
/// which nothing fits; of a crumb no wider than the gutter only the hull.
Loops reduced(const Outline& outline, double tolerance, double gutter);

/// Convex hull, counter-clockwise without collinear points (Andrew's monotone chain).
std::vector<Vec2> convex_hull(std::vector<Vec2> points);

}  // namespace partuv::packing
