#include "partuv/simplify.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "mesh/simplify_collapse.hpp"
#include "mesh/simplify_mesh.hpp"
#include "mesh/simplify_provenance.hpp"

namespace partuv {
namespace {

/// The same surface in units of the square root of its area, about its centre.
Surface normalised(const Surface& source) {
  Surface scaled = source;
  double area = 0.0;
  for (int f = 0; f < source.face_count(); ++f) area += 0.5 * face_cross(source, f).norm();
  Eigen::AlignedBox3d box;
  for (const Triangle& t : source.faces) {
    for (const int v : t) box.extend(source.positions[v]);
  }
  if (box.isEmpty()) return scaled;
  const Vec3 centre = box.center();
  const double extent = area > 0.0 ? std::sqrt(area) : box.sizes().maxCoeff();
  const double scale = extent > 0.0 ? 1.0 / extent : 1.0;
  for (Vec3& p : scaled.positions) p = (p - centre) * scale;
  return scaled;
}

detail::CollapseBudget make_budget(const Surface& scaled, const SimplifyOptions& options) {
  detail::CollapseBudget budget;
  budget.max_error = options.max_error;
  std::vector<int32_t> component;
  budget.components.resize(label_components(scaled, component));
  budget.component_of_vertex.assign(scaled.vertex_count(), -1);
  for (int f = 0; f < scaled.face_count(); ++f) {
    detail::ComponentBudget& own = budget.components[component[f]];
    own.area += 0.5 * face_cross(scaled, f).norm();
    ++own.faces;
    for (const int v : scaled.faces[f]) budget.component_of_vertex[v] = component[f];
  }
  // Small components keep their faces, and leave at least half of the target to the others.
  constexpr int least_floor = 64, largest_floor = 200;
  const int share = options.target_faces / std::max<int>(1, 2 * budget.components.size());
  const int floor_faces = std::clamp(share, least_floor, largest_floor);
  int small_faces = 0;
  for (detail::ComponentBudget& own : budget.components) {
    own.floor_faces = std::min(own.faces, floor_faces);
    if (own.faces == own.floor_faces) small_faces += own.faces;
  }
  budget.target_faces =
      small_faces + std::max(options.target_faces / 2, options.target_faces - small_faces);
  return budget;
}

}  // namespace

Proxy simplify(const Surface& source, const SimplifyOptions& options, const Context& context) {
  const Surface scaled = normalised(source);
  detail::EditableSurface edited(scaled);
  detail::CollapseBudget budget = make_budget(scaled, options);
  std::vector<int32_t> heir_of(source.face_count(), -1);
  detail::flip_poor_pairs(edited, context);
  detail::collapse_edges(edited, budget, heir_of, context);
  detail::flip_poor_pairs(edited, context);
  if (context.cancelled()) return {};

  // Number what is left in the order of the source.
  Proxy proxy;
  Surface scaled_proxy;
  std::vector<int32_t> new_vertex(source.vertex_count(), -1), new_face(source.face_count(), -1);
  for (int f = 0; f < source.face_count(); ++f) {
    if (!edited.face_alive(f)) continue;
    new_face[f] = proxy.surface.face_count();
    proxy.surface.faces.push_back(edited.face(f));
    for (const int v : edited.face(f)) new_vertex[v] = 0;
  }
  for (int v = 0; v < source.vertex_count(); ++v) {
    if (new_vertex[v] < 0) continue;
    new_vertex[v] = proxy.surface.vertex_count();
    proxy.surface.positions.push_back(source.positions[v]);
    scaled_proxy.positions.push_back(scaled.positions[v]);
  }
  proxy.surface.opposite.reserve(proxy.surface.faces.size());
  for (int f = 0; f < source.face_count(); ++f) {
    if (!edited.face_alive(f)) continue;
    Triangle across;
    for (int s = 0; s < 3; ++s) {
      const int h = edited.opposite(3 * f + s);
      across[s] = h < 0 ? -1 : 3 * new_face[h / 3] + h % 3;
    }
    proxy.surface.opposite.push_back(across);
  }
  for (Triangle& t : proxy.surface.faces) {
    for (int32_t& v : t) v = new_vertex[v];
  }
  scaled_proxy.faces = proxy.surface.faces;
  scaled_proxy.opposite = proxy.surface.opposite;

  // The heir of a face may have been removed later: follow the chain, shortening it.
  proxy.proxy_of_face.resize(source.face_count());
  for (int f = 0; f < source.face_count(); ++f) {
    int last = f;
    while (!edited.face_alive(last)) last = heir_of[last];
    for (int g = f; g != last;) {
      const int next = heir_of[g];
      heir_of[g] = last;
      g = next;
    }
    proxy.proxy_of_face[f] = new_face[last];
  }
  const double mean_edge = std::sqrt(2.0 / std::max(1, proxy.surface.face_count()));
  detail::settle_provenance(scaled, scaled_proxy, mean_edge, proxy.proxy_of_face, context);
  return proxy;
}

}  // namespace partuv
