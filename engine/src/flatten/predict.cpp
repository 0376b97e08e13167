#include <algorithm>
#include <cmath>

#include "flatten/system.hpp"
#include "partuv/flatten.hpp"

namespace partuv {
std::vector<RestTriangle> scaled_shapes(const Surface& s, const std::vector<double>& log_scale) {
  std::vector<RestTriangle> shapes(s.faces.size());
  for (int f = 0; f < s.face_count(); ++f) {
    const Triangle& t = s.faces[f];
    double length[3];  // of side k, from corner k to the next
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      length[k] = std::max((s.positions[b] - s.positions[a]).norm(), 1e-12) *
                  std::exp(0.5 * (log_scale[a] + log_scale[b]));
    }
    const double x =
        (length[0] * length[0] + length[2] * length[2] - length[1] * length[1]) / (2.0 * length[0]);
    const double y2 = length[2] * length[2] - x * x;
    const double floor = 1e-4 * std::max({length[0], length[1], length[2]});
    shapes[f] = {length[0], x, y2 > floor * floor ? std::sqrt(y2) : floor};
  }
  return shapes;
}

ConformalScale predict_scale(const Piece& piece, const Context& context) {
  const Surface& s = piece.surface;
  ConformalScale result;
  result.log_scale.assign(s.vertex_count(), 0.0);
  const std::vector<char> boundary = boundary_vertices(s);
  std::vector<int32_t> unknown(s.vertex_count(), -1);
  int inner = 0;
  for (int v = 0; v < s.vertex_count(); ++v) {
    if (!boundary[v]) unknown[v] = inner++;
  }
  const std::vector<RestTriangle> rest = rest_shapes(s, 1e-3);
  if (inner > 0) {
    std::vector<Triangle> faces = s.faces;
    for (Triangle& t : faces) {
      for (int& v : t) v = unknown[v];
    }
    MeshSystem<1> system(faces, inner);
    for (int f = 0; f < s.face_count(); ++f) {
      const RestTriangle& r = rest[f];
      const double gx[3] = {-1.0 / r.length, 1.0 / r.length, 0.0};
      const double gy[3] = {(r.x - r.length) / (r.length * r.y), -r.x / (r.length * r.y),
                            1.0 / r.y};
      const double w = r.area();
      system.add(f, [&](int i, int j) { return w * (gx[i] * gx[j] + gy[i] * gy[j]); });
    }
    // The metric exp(2u) g is flat where L u = -K, L the (positive) Laplacian.
    const std::vector<double> defect = angle_defects(piece);
    Eigen::VectorXd rhs(inner);
    for (int v = 0; v < s.vertex_count(); ++v) {
      if (unknown[v] >= 0) rhs[unknown[v]] = -defect[v];
    }
    if (!system.factor(1e-12 * system.mean_diagonal(), context)) {
      result.area_distortion = 10.0;
      return result;
    }
    const Eigen::VectorXd x = system.solve(rhs);
    for (int v = 0; v < s.vertex_count(); ++v) {
      if (unknown[v] >= 0) result.log_scale[v] = std::clamp(x[unknown[v]], -20.0, 20.0);
    }
  }

  std::vector<double> stretch(s.face_count());
  double area_3d = 0.0, area_2d = 0.0, count = 0.0;
  for (int f = 0; f < s.face_count(); ++f) {
    const Triangle& t = s.faces[f];
    const double u =
        (result.log_scale[t[0]] + result.log_scale[t[1]] + result.log_scale[t[2]]) / 3.0;
    stretch[f] = std::exp(2.0 * u);
    area_3d += rest[f].area();
    area_2d += rest[f].area() * stretch[f];
    count += piece.weight[f];
  }
  const double mean = area_2d / area_3d;
  double by_face = 0.0;
  for (int f = 0; f < s.face_count(); ++f) {
    const double ratio = stretch[f] / mean;
    by_face += piece.weight[f] * std::min(std::max(ratio, 1.0 / ratio), 10.0);
  }
  result.area_distortion = by_face / count;
  return result;
}

}  // namespace partuv
