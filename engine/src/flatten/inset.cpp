#include <algorithm>
#include <limits>

#include "partuv/flatten.hpp"
#include "planar.hpp"

namespace partuv {

std::vector<Vec2> inset_boundary(const Piece& piece, const std::vector<Vec2>& uv) {
  // Far less than a face, and far more than rounding, in single precision too.
  constexpr double share = 0.01;
  const Surface& s = piece.surface;
  std::vector<Vec2> inward(uv.size(), Vec2::Zero());
  for (const auto& loop : piece.loops) {
    for (const int h : loop) {
      const int from = s.faces[h / 3][h % 3], to = s.faces[h / 3][(h % 3 + 1) % 3];
      const Vec2 side = (uv[to] - uv[from]).normalized();
      for (const int v : {from, to}) inward[v] += Vec2(-side.y(), side.x());
    }
  }
  // No vertex goes far enough to turn a face over.
  std::vector<double> room(uv.size(), std::numeric_limits<double>::infinity());
  for (const Triangle& t : s.faces) {
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (uv[t[(k + 1) % 3]] - uv[t[k]]).norm());
    const double height = longest > 0.0 ? turn(uv[t[0]], uv[t[1]], uv[t[2]]) / longest : 0.0;
    for (const int v : t) room[v] = std::min(room[v], height);
  }
  constexpr double rounding = 1e-6;  // of sums of unit normals
  std::vector<Vec2> inset = uv;
  for (size_t v = 0; v < uv.size(); ++v) {
    inset[v] += share * std::max(room[v], 0.0) * direction_of_sum(inward[v], rounding);
  }
  return inset;
}

}  // namespace partuv
