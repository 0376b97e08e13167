#include <algorithm>

#include "partuv/flatten.hpp"

namespace partuv {

bool unfold(const Piece& piece, const std::vector<RestTriangle>& rest, std::vector<char> placed,
            std::vector<Vec2>& uv) {
  const Surface& s = piece.surface;
  std::vector<char> reached(s.faces.size(), 0);
  std::vector<int32_t> queue;
  for (int f = 0; f < s.face_count(); ++f) {
    const Triangle& t = s.faces[f];
    if (!placed[t[0]] || !placed[t[1]] || !placed[t[2]]) continue;
    reached[f] = 1;
    queue.push_back(f);
  }
  auto corner = [&](int f, int k) {
    const RestTriangle& r = rest[f];
    return k == 0 ? Vec2(0.0, 0.0) : k == 1 ? Vec2(r.length, 0.0) : Vec2(r.x, r.y);
  };
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
      if (!(norm > 0.0)) return false;
      const double cosine = from.dot(to) / norm;
      const double sine = (from.x() * to.y() - from.y() * to.x()) / norm;
      uv[tip] = 0.5 * (a + b) + Vec2(cosine * offset.x() - sine * offset.y(),
                                     sine * offset.x() + cosine * offset.y());
    }
  }
  return std::find(placed.begin(), placed.end(), 0) == placed.end();
}

std::vector<Vec2> unfolded_layout(const Piece& piece, const std::vector<RestTriangle>& rest) {
  std::vector<Vec2> uv(piece.surface.positions.size(), Vec2::Zero());
  std::vector<char> placed(uv.size(), 0);
  const Triangle& first = piece.surface.faces.front();
  uv[first[1]] = Vec2(rest.front().length, 0.0);
  uv[first[2]] = Vec2(rest.front().x, rest.front().y);
  for (int v : first) placed[v] = 1;
  if (!unfold(piece, rest, std::move(placed), uv)) return {};
  return uv;
}

}  // namespace partuv
