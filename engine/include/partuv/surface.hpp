#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "partuv/types.hpp"

namespace partuv {

/// An oriented 2-manifold with boundary, in flat arrays: what every stage after the weld works on.
///
/// Side s of face f runs from corner s to corner (s + 1) % 3 and is the half-edge 3 * f + s.
struct Surface {
  std::vector<Vec3> positions;  ///< one per vertex; every vertex is a single fan or disk of faces
  std::vector<Triangle> faces;  ///< F x 3 vertices, no repeated vertex within a face
  std::vector<Triangle> opposite;  ///< F x 3: the half-edge on the other side, or -1 at a boundary

  int face_count() const { return static_cast<int>(faces.size()); }
  int vertex_count() const { return static_cast<int>(positions.size()); }
};

/// Twice-area-weighted (not normalised) normal of face f.
inline Vec3 face_cross(const Surface& surface, int f) {
  const Triangle& t = surface.faces[f];
  const Vec3& a = surface.positions[t[0]];
  return (surface.positions[t[1]] - a).cross(surface.positions[t[2]] - a);
}

/// Length of side (half-edge) h in space.
inline double side_length(const Surface& surface, int h) {
  const Triangle& t = surface.faces[h / 3];
  return (surface.positions[t[(h % 3 + 1) % 3]] - surface.positions[t[h % 3]]).norm();
}

inline double surface_area(const Surface& surface) {
  double twice = 0.0;
  for (int f = 0; f < surface.face_count(); ++f) twice += face_cross(surface, f).norm();
  return 0.5 * twice;
}

/// Link sides that run between the same two vertices in opposite directions; those that are linked
/// already stay so. A side never meets a copy of its own face: sheets that lie on each other stay
/// apart. At an edge of more than two sides `mesh/edge_partners.hpp` says which meet; `numbers` are
/// the vertices in the caller's mesh at the corners of each face, if those say more than the
/// surface's. The rest becomes boundary.
void link_opposites(Surface& surface, std::span<const Triangle> numbers = {});

/// Component number of each face (faces joined across sides), numbered by smallest face; returns
/// how many there are.
int label_components(const Surface& surface, std::vector<int32_t>& component);

}  // namespace partuv
