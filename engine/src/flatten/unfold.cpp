#include <cmath>

#include "partuv/flatten.hpp"

namespace partuv {

std::vector<Vec2> unfolded_layout(const Piece& piece, const std::vector<RestTriangle>& rest) {
  const Surface& s = piece.surface;
  std::vector<Vec2> uv(s.positions.size(), Vec2::Zero());
  std::vector<char> placed(uv.size(), 0), reached(s.faces.size(), 0);
  auto corner = [&](int f, int k) {
    const RestTriangle& r = rest[f];
    return k == 0 ? Vec2(0.0, 0.0) : k == 1 ? Vec2(r.length, 0.0) : Vec2(r.x, r.y);
  };
  for (int k = 0; k < 3; ++k) {
    uv[s.faces.front()[k]] = corner(0, k);
    placed[s.faces.front()[k]] = 1;
  }
  std::vector<int32_t> queue{0};
  reached[0] = 1;
  for (size_t at = 0; at < queue.size(); ++at) {
    for (const int h : s.opposite[queue[at]]) {
      if (h < 0 || reached[h / 3]) continue;
      const int f = h / 3, k = h % 3;
      reached[f] = 1;
      queue.push_back(f);
      const int tip = s.faces[f][(k + 2) % 3];
      if (placed[tip]) continue;
      placed[tip] = 1;
      // From the middle of the common side at the true lengths: a similar triangle would multiply
      // the error from face to face.
      const Vec2 &a = uv[s.faces[f][k]], &b = uv[s.faces[f][(k + 1) % 3]];
      const Vec2 p = corner(f, k), q = corner(f, (k + 1) % 3);
      const Vec2 from = q - p, to = b - a, offset = corner(f, (k + 2) % 3) - 0.5 * (p + q);
      const double norm = from.norm() * to.norm();
      if (!(norm > 0.0)) return {};
      const double cosine = from.dot(to) / norm;
      const double sine = (from.x() * to.y() - from.y() * to.x()) / norm;
      uv[tip] = 0.5 * (a + b) + Vec2(cosine * offset.x() - sine * offset.y(),
                                     sine * offset.x() + cosine * offset.y());
    }
  }
  return uv;
}

}  // namespace partuv
