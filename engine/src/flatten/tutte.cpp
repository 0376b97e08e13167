// Barycentric embedding: Tutte 1963.
#include <cmath>
#include <numbers>

#include "flatten/system.hpp"
#include "partuv/flatten.hpp"

namespace partuv {

std::vector<Vec2> tutte_layout(const Piece& piece, const Context& context) {
  const Surface& s = piece.surface;
  if (piece.loops.empty()) return {};
  std::vector<Triangle> faces = s.faces;
  int count = s.vertex_count();
  // Inner loops are closed by a fan around one extra vertex.
  for (size_t l = 1; l < piece.loops.size(); ++l) {
    for (int h : piece.loops[l]) {
      faces.push_back({s.faces[h / 3][(h % 3 + 1) % 3], s.faces[h / 3][h % 3], count});
    }
    ++count;
  }
  const std::vector<int32_t>& rim = piece.loops.front();
  std::vector<double> along(rim.size() + 1, 0.0);
  for (size_t i = 0; i < rim.size(); ++i) {
    const Triangle& t = s.faces[rim[i] / 3];
    const int k = rim[i] % 3;
    along[i + 1] =
        along[i] + std::max((s.positions[t[(k + 1) % 3]] - s.positions[t[k]]).norm(), 1e-12);
  }
  double area = 0.0;
  for (int f = 0; f < s.face_count(); ++f) area += 0.5 * face_cross(s, f).norm();
  const double radius = std::sqrt(std::max(area, 1e-30) / std::numbers::pi);
  std::vector<Vec2> uv(count, Vec2::Zero());
  std::vector<char> fixed(count, 0);
  for (size_t i = 0; i < rim.size(); ++i) {
    const int v = s.faces[rim[i] / 3][rim[i] % 3];
    const double angle = 2.0 * std::numbers::pi * along[i] / along.back();
    uv[v] = radius * Vec2(std::cos(angle), std::sin(angle));
    fixed[v] = 1;
  }

  std::vector<int32_t> unknown(count, -1);
  int unknowns = 0;
  for (int v = 0; v < count; ++v) {
    if (!fixed[v]) unknown[v] = unknowns++;
  }
  if (unknowns > 0) {
    std::vector<Triangle> inner = faces;
    for (Triangle& t : inner) {
      for (int& v : t) v = unknown[v];
    }
    MeshSystem<1> system(inner, unknowns);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns), y = x;
    for (size_t f = 0; f < faces.size(); ++f) {
      const Triangle& t = faces[f];
      // Unit weight per side and face: each inner edge counts twice.
      system.add(static_cast<int>(f), [](int i, int j) { return i == j ? 2.0 : -1.0; });
      for (int i = 0; i < 3; ++i) {
        if (fixed[t[i]]) continue;
        for (int j = 0; j < 3; ++j) {
          if (j == i || !fixed[t[j]]) continue;
          x[unknown[t[i]]] += uv[t[j]].x();
          y[unknown[t[i]]] += uv[t[j]].y();
        }
      }
    }
    if (!system.factor(0.0, context)) return {};
    x = system.solve(x);
    y = system.solve(y);
    for (int v = 0; v < count; ++v) {
      if (!fixed[v]) uv[v] = Vec2(x[unknown[v]], y[unknown[v]]);
    }
  }
  uv.resize(s.vertex_count());
  return uv;
}

}  // namespace partuv
