// Least-squares conformal maps: Levy, Petitjean, Ray, Maillot 2002.
#include <algorithm>
#include <cmath>

#include "flatten/system.hpp"
#include "partuv/flatten.hpp"
#include "planar.hpp"

namespace partuv {
namespace {

/// Two boundary vertices far from each other (two sweeps), or any two where there is no boundary.
std::pair<int, int> far_vertices(const Piece& piece) {
  std::vector<int32_t> candidates;
  for (const auto& loop : piece.loops) {
    for (int h : loop) candidates.push_back(piece.surface.faces[h / 3][h % 3]);
    break;
  }
  if (candidates.empty()) {
    for (int v = 0; v < piece.surface.vertex_count(); ++v) candidates.push_back(v);
  }
  auto farthest = [&](int from) {
    int best = from;
    double reach = -1.0;
    for (int v : candidates) {
      const double d = (piece.surface.positions[v] - piece.surface.positions[from]).squaredNorm();
      if (v != from && d > reach) {
        reach = d;
        best = v;
      }
    }
    return best;
  };
  const int a = farthest(candidates.front());
  return {a, farthest(a)};
}

}  // namespace

bool scale_to_area(const Piece& piece, const std::vector<RestTriangle>& rest,
                   std::vector<Vec2>& uv) {
  double area = 0.0;
  for (const RestTriangle& shape : rest) area += shape.area();
  const double laid = signed_area(piece.surface.faces, uv);
  if (!(laid > 0.0)) return false;
  const double scale = std::sqrt(area / laid);
  for (Vec2& p : uv) p *= scale;
  return true;
}

bool conformal_extension(const Piece& piece, const std::vector<RestTriangle>& rest,
                         const std::vector<char>& fixed, const Context& context,
                         MeshSystem<2>& system, std::vector<Vec2>& uv) {
  const Surface& s = piece.surface;
  system.clear();
  for (int f = 0; f < s.face_count(); ++f) {
    const RestTriangle& r = rest[f];
    // Gradients of the three hat functions in the rest frame.
    const double gx[3] = {-1.0 / r.length, 1.0 / r.length, 0.0};
    const double gy[3] = {(r.x - r.length) / (r.length * r.y), -r.x / (r.length * r.y), 1.0 / r.y};
    // Cauchy-Riemann residuals u_x - v_y and u_y + v_x, squared and weighted by area.
    double p[6], q[6];
    for (int k = 0; k < 3; ++k) {
      p[2 * k] = gx[k];
      p[2 * k + 1] = -gy[k];
      q[2 * k] = gy[k];
      q[2 * k + 1] = gx[k];
    }
    const double w = r.area();
    system.add(f, [&](int i, int j) { return w * (p[i] * p[j] + q[i] * q[j]); });
  }
  const double pin = 1e8 * system.mean_diagonal();
  if (!(pin > 0.0) || !std::isfinite(pin)) return false;
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(2 * s.vertex_count());
  for (int v = 0; v < s.vertex_count(); ++v) {
    if (!fixed[v]) continue;
    for (int d = 0; d < 2; ++d) system.add_diagonal(v, d, pin);
    rhs.segment<2>(2 * v) = pin * uv[v];
  }
  if (!system.factor(0.0, context)) return false;
  const Eigen::VectorXd x = system.solve(rhs);
  if (!x.allFinite()) return false;
  for (int v = 0; v < s.vertex_count(); ++v) uv[v] = x.segment<2>(2 * v);
  return true;
}

std::vector<Vec2> conformal_layout(const Piece& piece, const std::vector<RestTriangle>& rest,
                                   const Context& context, MeshSystem<2>& system) {
  const Surface& s = piece.surface;
  const auto [a, b] = far_vertices(piece);
  const double span = (s.positions[b] - s.positions[a]).norm();
  std::vector<char> fixed(s.positions.size(), 0);
  std::vector<Vec2> uv(s.positions.size(), Vec2::Zero());
  fixed[a] = fixed[b] = 1;
  uv[b].x() = span > 0.0 ? span : 1.0;
  if (!conformal_extension(piece, rest, fixed, context, system, uv)) return {};
  if (!scale_to_area(piece, rest, uv)) return {};
  return uv;
}

}  // namespace partuv
