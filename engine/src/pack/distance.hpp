#pragma once

#include <cstdint>
#include <vector>

#include "pack/layout.hpp"

namespace partuv::packing {

/// The boundary segments of all charts as placed, chart after chart.
struct PlacedSegments {
  std::vector<Segment> segments;
  std::vector<int32_t> chart;  ///< of each segment
};

/// Segments in texels of a layout; the charts, not the places, are `growth` times as large.
PlacedSegments place_segments(const std::vector<Outline>& charts, const Layout& layout,
                              double growth = 1.0);

struct NearPair {
  int32_t one, two;  ///< segments, one < two, of different charts
  double distance;
};

/// Every pair of segments of different charts at most `reach` apart, ordered by indices.
/// Near-linear while few charts share a neighbourhood.
std::vector<NearPair> near_pairs(const PlacedSegments& placed, double reach);

/// The smallest distance between segments of different charts, or `reach` if that is less.
double least_distance(const PlacedSegments& placed, double reach);

/// Distance between two segments, 0 where they cross.
double segment_distance(const Segment& one, const Segment& two);

}  // namespace partuv::packing
