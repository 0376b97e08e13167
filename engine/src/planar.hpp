#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "partuv/types.hpp"

namespace partuv {

/// Twice the signed area of a triangle in the plane: positive where a, b, c turn counter-clockwise.
inline double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Length of the longest side of a triangle in the plane.
inline double longest_side(const Vec2& a, const Vec2& b, const Vec2& c) {
  return std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
}

/// Share of a map's extent within which its sides touch: where the surface's own flaps lie side by
/// side when unfolded, rounding must not say whether they overlap, nor how far a solver converged.
constexpr double touching_share = 1e-9;

/// The unit vector along a sum of vectors; none where they cancel but for rounding, as the normals
/// of the two sides do at the tip of a slit.
inline Vec2 direction_of_sum(const Vec2& sum, double rounding) {
  const double length = sum.norm();
  return length > rounding ? Vec2(sum / length) : Vec2(Vec2::Zero());
}

/// Area of a map; faces that run clockwise count below zero.
inline double signed_area(const std::vector<Triangle>& faces, const std::vector<Vec2>& uv) {
  double area = 0.0;
  for (const Triangle& t : faces) area += 0.5 * turn(uv[t[0]], uv[t[1]], uv[t[2]]);
  return area;
}

}  // namespace partuv
