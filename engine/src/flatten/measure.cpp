#include <algorithm>
#include <cmath>
#include <numbers>

#include "partuv/flatten.hpp"

namespace partuv {

double angular_score(double s1, double s2) {
  const double a = s1 * s1, b = s2 * s2;
  const double ratio = a + b > 0.0 ? std::min((a - b) / (a + b), 1.0) : 1.0;
  return 1.0 - (2.0 / std::numbers::pi) * std::asin(std::max(ratio, 0.0));
}

Distortion measure(const Piece& piece, const std::vector<Vec2>& uv, double least_area) {
  const Surface& s = piece.surface;
  const int n = s.face_count();
  std::vector<double> area_3d(n), area_2d(n);
  double sum_3d = 0.0, sum_2d = 0.0, sum_weight = 0.0, sum_angular = 0.0, sum_axes = 0.0;
  Distortion result;
  for (int f = 0; f < n; ++f) {
    const Triangle& t = s.faces[f];
    const Vec3 d1 = s.positions[t[1]] - s.positions[t[0]];
    const Vec3 d2 = s.positions[t[2]] - s.positions[t[0]];
    const Vec2 e1 = uv[t[1]] - uv[t[0]], e2 = uv[t[2]] - uv[t[0]];
    area_3d[f] = 0.5 * d1.cross(d2).norm();
    const double det = e1.x() * e2.y() - e1.y() * e2.x();
    area_2d[f] = 0.5 * std::abs(det);
    if (area_3d[f] <= least_area) continue;
    if (!(det > 0.0)) ++result.flipped;
    sum_3d += area_3d[f];
    sum_2d += area_2d[f];
    sum_weight += piece.weight[f];
    // Images in 3D of the U and V axes, up to the factor det.
    const Vec3 tangent = e2.y() * d1 - e1.y() * d2, bitangent = e1.x() * d2 - e2.x() * d1;
    const double tt = tangent.squaredNorm(), bb = bitangent.squaredNorm();
    if (tt + bb > 0.0 && det != 0.0) {
      const double dot = tangent.dot(bitangent);
      const double spread = std::sqrt((tt - bb) * (tt - bb) + 4.0 * dot * dot);
      const double ratio = std::min(spread / (tt + bb), 1.0);
      const double cosine = std::abs(dot) / std::sqrt(tt * bb);
      sum_axes += piece.weight[f] * (1.0 - std::min(cosine, 1.0));
      sum_angular += piece.weight[f] * (1.0 - (2.0 / std::numbers::pi) * std::asin(ratio));
    }
  }
  if (sum_weight == 0.0) return result;
  double sum_area = 0.0;
  for (int f = 0; f < n; ++f) {
    if (area_3d[f] <= least_area) continue;
    double d = most_face_distortion;
    if (area_2d[f] > 0.0 && sum_2d > 0.0) {
      const double stretch = (area_2d[f] / area_3d[f]) / (sum_2d / sum_3d);
      d = std::min(std::max(stretch, 1.0 / stretch), most_face_distortion);
    }
    sum_area += piece.weight[f] * d;
  }
  result.area = sum_area / sum_weight;
  result.angular = sum_angular / sum_weight;
  result.angular_axes = sum_axes / sum_weight;
  return result;
}

}  // namespace partuv
