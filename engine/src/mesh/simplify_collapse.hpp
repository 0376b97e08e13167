#pragma once

#include <cstdint>
#include <vector>

#include "mesh/simplify_mesh.hpp"
#include "partuv/context.hpp"

namespace partuv::detail {

/// What the collapses have to respect, per component of the surface.
struct ComponentBudget {
  double area = 0.0;
  int faces = 0;        ///< how many are left
  int floor_faces = 0;  ///< keep at least so many, needles aside
};

struct CollapseBudget {
  int target_faces = 0;
  double max_error = 0.0;  ///< share of the square root of a component's area
  std::vector<int32_t> component_of_vertex;
  std::vector<ComponentBudget> components;
};

/// 4 sqrt(3) area over the sum of squared sides: 1 for an equilateral triangle, 0 for a degenerate.
double triangle_quality(const Vec3& a, const Vec3& b, const Vec3& c);

/// Collapse edges, cheapest first, until the budget is met; past it go on only where a needle goes
/// away at no error. O(F log F) in effect linear: a bucket queue with every vertex in it once.
void collapse_edges(EditableSurface& surface, CollapseBudget& budget, std::vector<int32_t>& heir_of,
                    const Context& context);

/// Swap the diagonals of nearly flat pairs of triangles where that betters a poor triangle.
void flip_poor_pairs(EditableSurface& surface, const Context& context);

}  // namespace partuv::detail
