#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "partuv/surface.hpp"
#include "partuv/tree_nbm.hpp"

namespace partuv {

/// A side shared by two faces, as the part trees see it.
struct DualEdge {
  int32_t a = -1, b = -1;   ///< the faces, a < b
  double length = 0.0;      ///< in units of the square root of the whole area
  double similarity = 1.0;  ///< 1 across a flat side, `least_similarity` across the sharpest crease
};

/// One edge per shared side (two faces may share several), all alike: similarity 1.
std::vector<DualEdge> dual_edges(const Surface& surface);

/// The same with similarities by concavity: see `build_nbm_tree`.
std::vector<DualEdge> crease_edges(const Surface& surface, const NbmOptions& options);

/// Share of the whole area that each face has. A face below a billionth of the mean counts as that
/// much, so that ratios stay finite. `override_areas` (empty: none) replaces the surface's.
std::vector<double> area_shares(const Surface& surface, std::span<const double> override_areas);

}  // namespace partuv
