#include "segment/thin.hpp"

#include <algorithm>
#include <cmath>

#include "planar.hpp"

namespace partuv {
namespace {

/// Length of the outline of a map.
double map_perimeter(const Flattening& flat) {
  double perimeter = 0.0;
  for (const std::vector<int32_t>& loop : flat.piece.loops) {
    for (const int h : loop) {
      const Triangle& t = flat.piece.surface.faces[h / 3];
      perimeter += (flat.uv[t[(h % 3 + 1) % 3]] - flat.uv[t[h % 3]]).norm();
    }
  }
  return perimeter;
}

double map_area(const Flattening& flat) { return signed_area(flat.piece.surface.faces, flat.uv); }

}  // namespace

double mean_width(const Flattening& flat) {
  const double perimeter = map_perimeter(flat);
  return perimeter > 0.0 ? 2.0 * map_area(flat) / perimeter : 0.0;
}

double narrow_width(const Flattening& flat) {
  // Sides a and b of a rectangle: a + b is half the perimeter, a b the area.
  const double quarter = 0.25 * map_perimeter(flat);
  return quarter - std::sqrt(std::max(quarter * quarter - map_area(flat), 0.0));
}

bool survives_rounding(const Flattening& flat, const SearchOptions& options) {
  if (options.rounding_step == 0.0) return true;
  constexpr double safe_steps = 4.0;
  const Surface& s = flat.piece.surface;
  int thin = 0;
  for (int f = 0; f < s.face_count(); ++f) {
    const Triangle& t = s.faces[f];
    const Vec2 &a = flat.uv[t[0]], &b = flat.uv[t[1]], &c = flat.uv[t[2]];
    thin += turn(a, b, c) < safe_steps * options.rounding_step * longest_side(a, b, c) &&
            0.5 * face_cross(s, f).norm() > options.flatten.least_area;
  }
  return flat.distortion.area + (most_face_distortion - 1.0) * thin / s.face_count() <=
         options.flatten.max_area_distortion;
}

}  // namespace partuv
