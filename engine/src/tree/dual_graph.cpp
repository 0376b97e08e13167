#include "tree/dual_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "tree/steady_normals.hpp"

namespace partuv {

namespace {

constexpr double least_share_of_mean_area = 1e-9;
// A closed sheet folded onto itself encloses less than this share of area^1.5: no inside to speak
// of.
constexpr double least_volume = 1e-6;
constexpr double sigma_floor = 1e-6;

/// +1 for each component, or -1 where it is closed and encloses negative volume (inside out).
std::vector<double> outward_signs(const Surface& surface, const std::vector<int32_t>& component,
                                  int component_count) {
  std::vector<double> volume(component_count, 0.0), area(component_count, 0.0);
  std::vector<char> open(component_count, 0);
  std::vector<int32_t> pivot(component_count, -1);  // near the piece: less is lost to rounding
  for (int f = 0; f < surface.face_count(); ++f) {
    const int c = component[f];
    const Triangle& t = surface.faces[f];
    if (pivot[c] < 0) pivot[c] = t[0];
    const Vec3 cross = face_cross(surface, f);
    volume[c] += (surface.positions[t[0]] - surface.positions[pivot[c]]).dot(cross) / 6.0;
    area[c] += 0.5 * cross.norm();
    for (const int o : surface.opposite[f]) open[c] |= o < 0;
  }
  std::vector<double> sign(component_count, 1.0);
  for (int c = 0; c < component_count; ++c) {
    if (!open[c] && volume[c] < -least_volume * std::pow(area[c], 1.5)) sign[c] = -1.0;
  }
  return sign;
}

}  // namespace

std::vector<DualEdge> dual_edges(const Surface& surface) {
  const double total = surface_area(surface);
  const double unit = total > 0.0 ? 1.0 / std::sqrt(total) : 0.0;
  std::vector<DualEdge> edges;
  edges.reserve(3 * surface.faces.size() / 2);
  for (int f = 0; f < surface.face_count(); ++f) {
    for (int s = 0; s < 3; ++s) {
      const int g = surface.opposite[f][s] / 3;
      if (surface.opposite[f][s] < 0 || g <= f) continue;
      edges.push_back({f, g, side_length(surface, 3 * f + s) * unit, 1.0});
    }
  }
  return edges;
}

std::vector<DualEdge> crease_edges(const Surface& surface, const NbmOptions& options) {
  std::vector<DualEdge> edges = dual_edges(surface);
  const std::vector<Vec3> normals = steady_normals(surface);
  std::vector<int32_t> component;
  const int components = label_components(surface, component);
  const std::vector<double> sign = outward_signs(surface, component, components);
  auto corner_sum = [&](int f) -> Vec3 {
    const Triangle& t = surface.faces[f];
    return surface.positions[t[0]] + surface.positions[t[1]] + surface.positions[t[2]];
  };
  double crease_sum = 0.0, length_sum = 0.0;
  for (DualEdge& e : edges) {
    const double rise = (corner_sum(e.b) - corner_sum(e.a)).dot(normals[e.a] - normals[e.b]);
    const double weight = rise * sign[component[e.a]] > 0.0 ? 1.0 : options.convex_weight;
    e.similarity = weight * std::max(0.0, 1.0 - normals[e.a].dot(normals[e.b]));  // the crease yet
    crease_sum += e.length * e.similarity;
    length_sum += e.length;
  }
  const double sigma = (length_sum > 0.0 ? crease_sum / length_sum : 0.0) + sigma_floor;
  for (DualEdge& e : edges) {
    e.similarity =
        std::max(options.least_similarity, std::exp(-options.contrast * e.similarity / sigma));
  }
  return edges;
}

std::vector<double> area_shares(const Surface& surface, std::span<const double> override_areas) {
  const int faces = surface.face_count();
  std::vector<double> share(faces);
  for (int f = 0; f < faces; ++f) {
    share[f] = override_areas.empty() ? 0.5 * face_cross(surface, f).norm() : override_areas[f];
  }
  const double total = std::accumulate(share.begin(), share.end(), 0.0);
  const double mean = 1.0 / std::max(faces, 1);
  for (double& a : share) {
    a = total > 0.0 ? std::max(a / total, least_share_of_mean_area * mean) : mean;
  }
  return share;
}

}  // namespace partuv
