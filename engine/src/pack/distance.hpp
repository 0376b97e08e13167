#pragma once

#include <cstdint>
#include <vector>

#include "pack/layout.hpp"

namespace partuv::packing {

/// The sides of all outlines as placed, chart after chart and loop after loop.
struct PlacedSides {
  std::vector<Segment> sides;
  std::vector<int32_t> chart;     ///< of each side
  std::vector<int32_t> previous;  ///< the side before it in its loop
  std::vector<int32_t> next;      ///< the side behind it
};

/// Sides in texels of a layout; loops[i] belongs to chart i.
PlacedSides place_sides(const std::vector<Loops>& loops, const Layout& layout);

struct NearPair {
  int32_t one, two;  ///< sides, one < two, of different charts
  double distance;
};

/// Every pair of sides of different charts at most `reach` apart, ordered by indices.
/// Near-linear while few charts share a neighbourhood.
std::vector<NearPair> near_pairs(const PlacedSides& placed, double reach);

/// The smallest distance between sides of different charts, or `reach` if that is less.
double least_distance(const PlacedSides& placed, double reach);

double point_distance(const Vec2& p, const Segment& s);

/// Whether two segments cross within both.
bool cross(const Segment& one, const Segment& two);

/// Distance between two segments, 0 where they cross.
double segment_distance(const Segment& one, const Segment& two);

}  // namespace partuv::packing
