#include "partuv/topology.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "disjoint_sets.hpp"
#include "mesh/canonical_frame.hpp"
#include "mesh/canonical_order.hpp"

namespace partuv {
namespace {

/// Number the referenced positions, equal numbers for exactly equal positions.
std::vector<int32_t> weld(const Mesh& mesh) {
  std::vector<int32_t> used;
  std::vector<char> referenced(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.faces) {
    for (int v : t) referenced[v] = 1;
  }
  for (size_t v = 0; v < referenced.size(); ++v) {
    if (referenced[v]) used.push_back(static_cast<int32_t>(v));
  }
  auto less = [&](int a, int b) {
    const Vec3 &p = mesh.positions[a], &q = mesh.positions[b];
    for (int k = 0; k < 3; ++k) {
      if (p[k] != q[k]) return p[k] < q[k];
    }
    return a < b;
  };
  std::vector<int32_t> sorted = used;
  std::sort(sorted.begin(), sorted.end(), less);
  std::vector<int32_t> first(mesh.positions.size(), -1);  // smallest equal vertex
  for (size_t i = 0; i < sorted.size(); ++i) {
    const bool same = i > 0 && mesh.positions[sorted[i]] == mesh.positions[sorted[i - 1]];
    first[sorted[i]] = same ? first[sorted[i - 1]] : sorted[i];
  }
  std::vector<int32_t> number(mesh.positions.size(), -1);
  int count = 0;
  for (int v : used) {
    number[v] = first[v] == v ? count++ : number[first[v]];
  }
  return number;
}

/// Centre and scale that bring the surface to the origin and to unit area.
void normalise(Topology& topology) {
  Surface& surface = topology.surface;
  Vec3 low = surface.positions.front(), high = low;
  for (const Vec3& p : surface.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 centre = 0.5 * (low + high);
  const double extent = (high - low).maxCoeff();
  if (extent > 0.0) {
    for (Vec3& p : surface.positions) p = (p - centre) / extent;
  }
  std::vector<double> areas(surface.faces.size());
  for (int f = 0; f < surface.face_count(); ++f) areas[f] = 0.5 * face_cross(surface, f).norm();
  std::sort(areas.begin(), areas.end());  // the sum does not depend on the order of the faces
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  topology.area = area * extent * extent;
  if (area > 0.0) {
    const double scale = 1.0 / std::sqrt(area);
    for (Vec3& p : surface.positions) p *= scale;
  }
}

}  // namespace

double least_area(const Surface& surface) {
  Vec3 low = surface.positions.front(), high = low;
  for (const Vec3& p : surface.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return 1e-14 * (high - low).squaredNorm();
}

Result<Topology> build_topology(const Mesh& mesh, const Context& context, Numbering numbering) {
  const Failure cancelled{Error::cancelled, "topology"};
  if (mesh.faces.empty()) return Failure{Error::empty_mesh, "faces"};
  const int vertex_count = static_cast<int>(mesh.positions.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int v : mesh.faces[f]) {
      if (v < 0 || v >= vertex_count) {
        return Failure{Error::index_out_of_range, "face " + std::to_string(f)};
      }
      if (!mesh.positions[v].allFinite()) {
        return Failure{Error::non_finite_position, "vertex " + std::to_string(v)};
      }
    }
  }

  Topology topology;
  const std::vector<int32_t> number = weld(mesh);
  if (context.cancelled()) return cancelled;
  topology.welded.resize(mesh.faces.size());
  Surface by_point;  // faces over welded points
  by_point.positions.resize(*std::max_element(number.begin(), number.end()) + 1);
  for (int v = vertex_count - 1; v >= 0; --v) {
    if (number[v] >= 0) by_point.positions[number[v]] = mesh.positions[v];
  }
  std::vector<Triangle> numbers;  // of the vertices in the caller's mesh
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    Triangle& t = topology.welded[f];
    for (int k = 0; k < 3; ++k) t[k] = number[mesh.faces[f][k]];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      topology.collapsed.push_back(static_cast<int32_t>(f));
    } else {
      topology.source_face.push_back(static_cast<int32_t>(f));
      by_point.faces.push_back(t);
      numbers.push_back(mesh.faces[f]);
    }
  }
  if (by_point.faces.empty()) return Failure{Error::no_face_with_area, "faces"};
  link_opposites(by_point, numbers);
  if (context.cancelled()) return cancelled;

  // Join corners across the linked sides: side s of f meets its opposite end to end.
  const int corner_count = 3 * by_point.face_count();
  DisjointSets vertices(corner_count);
  auto next_corner = [](int h) { return h - h % 3 + (h % 3 + 1) % 3; };
  for (int h = 0; h < corner_count; ++h) {
    const int other = by_point.opposite[h / 3][h % 3];
    if (other < h) continue;
    vertices.join(h, next_corner(other));
    vertices.join(next_corner(h), other);
  }

  Surface& surface = topology.surface;
  surface.faces.resize(by_point.faces.size());
  surface.opposite = by_point.opposite;
  std::vector<int32_t> vertex_of_corner(corner_count, -1);
  for (int c = 0; c < corner_count; ++c) {
    const int root = vertices.find(c);
    if (vertex_of_corner[root] < 0) {
      vertex_of_corner[root] = surface.vertex_count();
      const int point = by_point.faces[c / 3][c % 3];
      surface.positions.push_back(by_point.positions[point]);
      topology.source_vertex.push_back(point);
    }
    surface.faces[c / 3][c % 3] = vertex_of_corner[root];
  }
  topology.first_corner.assign(surface.faces.size(), 0);
  // Edges of more than two faces leave slits whose ends the faces around them have joined: nothing
  // could ever open them.
  link_opposites(surface);
  if (numbering == Numbering::canonical) detail::number_canonically(topology);
  normalise(topology);
  if (numbering == Numbering::canonical) detail::place_canonically(topology);
  const double least = least_area(surface);
  for (int f = 0; f < surface.face_count(); ++f) {
    if (0.5 * face_cross(surface, f).norm() > least) return topology;
  }
  return Failure{Error::no_face_with_area, "faces"};
}

}  // namespace partuv
