#include "mesh/simplify_mesh.hpp"

#include <Eigen/Geometry>
#include <utility>

namespace partuv::detail {

EditableSurface::EditableSurface(const Surface& source)
    : positions_(&source.positions),
      faces_(source.faces),
      opposite_(3 * source.faces.size()),
      first_(source.positions.size(), -1),
      valence_(source.positions.size(), 0),
      mark_(source.positions.size(), 0),
      alive_faces_(source.face_count()) {
  for (int h = 0; h < 3 * source.face_count(); ++h) {
    opposite_[h] = source.opposite[h / 3][h % 3];
    const int v = from(h);
    // One half-edge leaves v per face; a boundary vertex has one edge more.
    ++valence_[v];
    if (opposite_[h] < 0) ++valence_[to(h)];
    if (opposite_[h] < 0 || first_[v] < 0) first_[v] = h;
  }
}

void EditableSurface::link(int a, int b) {
  if (a >= 0) opposite_[a] = b;
  if (b >= 0) opposite_[b] = a;
}

void EditableSurface::set_first(int v, int leaving) {
  // Turn clockwise up to the boundary, if there is one.
  int h = leaving;
  for (int across = opposite_[h]; across >= 0; across = opposite_[h]) {
    h = next(across);
    if (h == leaving) break;
  }
  first_[v] = h;
}

bool EditableSurface::adjacent(int a, int b) const {
  if (valence_[a] > valence_[b]) std::swap(a, b);
  bool found = false;
  around_edges(a, [&](const Spoke& spoke) { found |= tip(spoke) == b; });
  return found;
}

bool EditableSurface::can_collapse(int u, const Spoke& spoke) {
  const int v = tip(spoke);
  const bool boundary_edge = spoke.out < 0 || spoke.in < 0;
  if (on_boundary(u) && !boundary_edge) return false;
  const int wing[2] = {spoke.out < 0 ? -1 : from(prev(spoke.out)),
                       spoke.in < 0 ? -1 : from(prev(spoke.in))};
  if (wing[0] == wing[1]) return false;
  const int wings = boundary_edge ? 1 : 2;
  for (const int w : wing) {
    // A closed fan keeps three edges at least, an open one two.
    if (w >= 0 && valence_[w] <= (on_boundary(w) ? 2 : 3)) return false;
  }
  if (valence_[u] + valence_[v] - wings - 2 < (on_boundary(v) ? 2 : 3)) return false;
  // The common neighbours must be the wings and nothing else, counted once per edge.
  ++stamp_;
  bool doubled = false;
  int edges_to_v = 0;
  around_edges(u, [&](const Spoke& s) {
    const int n = tip(s);
    doubled |= mark_[n] == stamp_;
    mark_[n] = stamp_;
    edges_to_v += n == v;
  });
  if (doubled || edges_to_v != 1) return false;
  int common = 0;
  constexpr int hub_valence = 32;
  if (valence_[v] <= hub_valence) {
    around_edges(v, [&](const Spoke& s) { common += mark_[tip(s)] == stamp_; });
  } else {
    around_edges(u, [&](const Spoke& s) { common += tip(s) != v && adjacent(tip(s), v); });
  }
  return common == wings;
}

int EditableSurface::heir(int face, int inner, int outer) const {
  // The star of the removed vertex, reached across `inner`, is what covers the old face; the
  // other side is better only where the inner edge is a crease.
  if (inner < 0) return outer / 3;
  if (outer < 0) return inner / 3;
  const auto normal = [&](int f) {
    const Triangle& t = faces_[f];
    const Vec3& a = position(t[0]);
    return Vec3((position(t[1]) - a).cross(position(t[2]) - a).stableNormalized());
  };
  const Vec3 own = normal(face);
  constexpr double same_side = 0.9;
  const double agreement = own.dot(normal(inner / 3));
  const bool stay = agreement >= same_side || agreement >= own.dot(normal(outer / 3));
  return (stay ? inner : outer) / 3;
}

void EditableSurface::collapse(int u, const Spoke& spoke, std::vector<int32_t>& heir_of) {
  const int v = tip(spoke);
  const int side[2] = {spoke.out, spoke.in};
  // Each lost face has an edge at u (inner) and one at v (outer): what lies across them.
  int inner[2] = {-1, -1}, outer[2] = {-1, -1}, wing[2] = {-1, -1};
  int removed = 0;
  for (int i = 0; i < 2; ++i) {
    if (side[i] < 0) continue;
    const int ahead = opposite_[next(side[i])], behind = opposite_[prev(side[i])];
    inner[i] = i == 0 ? behind : ahead;
    outer[i] = i == 0 ? ahead : behind;
    wing[i] = from(prev(side[i]));
    heir_of[side[i] / 3] = heir(side[i] / 3, inner[i], outer[i]);
    ++removed;
  }
  around(u, [&](int h) { faces_[h / 3][h % 3] = v; });
  for (int i = 0; i < 2; ++i) {
    if (side[i] < 0) continue;
    faces_[side[i] / 3] = {-1, -1, -1};
    link(inner[i], outer[i]);
    --valence_[wing[i]];
  }
  alive_faces_ -= removed;
  valence_[v] += valence_[u] - removed - 2;
  first_[u] = -1;
  for (int i = 0; i < 2; ++i) {
    if (side[i] < 0) continue;
    const int h = inner[i] >= 0 ? inner[i] : outer[i];
    for (const int leaving : {h, next(h)}) {
      const int x = from(leaving);
      if (!face_alive(first_[x] / 3)) set_first(x, leaving);
    }
  }
}

bool EditableSurface::can_flip(int h) const {
  const int back = opposite_[h];
  if (back < 0 || back / 3 == h / 3) return false;
  const int a = from(h), b = to(h);
  const int c = from(prev(h)), d = from(prev(back));
  if (c == d || adjacent(c, d)) return false;
  return valence_[a] > (on_boundary(a) ? 2 : 3) && valence_[b] > (on_boundary(b) ? 2 : 3);
}

void EditableSurface::flip(int h) {
  // Faces (a, b, c) and (b, a, d) become (a, d, c) and (d, b, c).
  const int back = opposite_[h];
  const int f = h / 3, g = back / 3;
  const int a = from(h), b = to(h);
  const int c = from(prev(h)), d = from(prev(back));
  const int bc = opposite_[next(h)], ca = opposite_[prev(h)];
  const int ad = opposite_[next(back)], db = opposite_[prev(back)];
  faces_[f] = {a, d, c};
  faces_[g] = {d, b, c};
  const int f0 = 3 * f, g0 = 3 * g;
  for (const int inside : {f0, f0 + 2, g0, g0 + 1}) opposite_[inside] = -1;
  link(f0, ad);
  link(f0 + 1, g0 + 2);
  link(f0 + 2, ca);
  link(g0, db);
  link(g0 + 1, bc);
  --valence_[a];
  --valence_[b];
  ++valence_[c];
  ++valence_[d];
  for (const int leaving : {f0, f0 + 1, f0 + 2, g0 + 1}) {
    const int x = from(leaving);
    if (first_[x] / 3 == f || first_[x] / 3 == g) set_first(x, leaving);
  }
}

}  // namespace partuv::detail
