#include <algorithm>
#include <cmath>
#include <queue>

#include "partuv/solve.hpp"
#include "segment/evaluator.hpp"

namespace partuv {
namespace {

/// Faces grown from a seed while their normals stay within a cone around it; degenerate faces join.
std::vector<std::vector<int32_t>> grow_flat_regions(const Surface& s,
                                                    const std::vector<int32_t>& faces,
                                                    double least_cosine, double least_area) {
  std::vector<int32_t> sorted = faces;
  std::sort(sorted.begin(), sorted.end());
  auto place = [&](int f) {
    const auto it = std::lower_bound(sorted.begin(), sorted.end(), f);
    return it != sorted.end() && *it == f ? static_cast<int>(it - sorted.begin()) : -1;
  };
  std::vector<Vec3> normal(sorted.size());
  std::vector<double> area(sorted.size());
  std::vector<int32_t> by_area(sorted.size());
  for (size_t i = 0; i < sorted.size(); ++i) {
    const Vec3 cross = face_cross(s, sorted[i]);
    area[i] = 0.5 * cross.norm();
    normal[i] = area[i] > least_area ? Vec3(cross.normalized()) : Vec3::Zero();
    by_area[i] = static_cast<int32_t>(i);
  }
  std::stable_sort(by_area.begin(), by_area.end(), [&](int a, int b) { return area[a] > area[b]; });
  std::vector<char> taken(sorted.size(), 0);
  std::vector<std::vector<int32_t>> regions;
  for (int seed : by_area) {
    if (taken[seed]) continue;
    std::vector<int32_t> region;
    std::vector<int32_t> queue{seed};
    taken[seed] = 1;
    for (size_t at = 0; at < queue.size(); ++at) {
      const int i = queue[at];
      region.push_back(sorted[i]);
      for (int h : s.opposite[sorted[i]]) {
        const int j = h < 0 ? -1 : place(h / 3);
        if (j < 0 || taken[j]) continue;
        const bool flat = normal[j].isZero() || normal[seed].isZero() ||
                          normal[j].dot(normal[seed]) >= least_cosine;
        if (!flat) continue;
        taken[j] = 1;
        queue.push_back(j);
      }
    }
    std::sort(region.begin(), region.end());
    regions.push_back(std::move(region));
  }
  return regions;
}

/// Lay a piece onto the plane of its mean normal.
std::vector<Vec2> projection(const Piece& piece) {
  const Surface& s = piece.surface;
  Vec3 normal = Vec3::Zero();
  for (int f = 0; f < s.face_count(); ++f) normal += face_cross(s, f);
  if (!(normal.norm() > 0.0)) normal = Vec3::UnitZ();
  normal.normalize();
  int axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Vec3 u = normal.cross(Vec3::Unit(axis)).normalized(), v = normal.cross(u);
  std::vector<Vec2> uv(s.positions.size());
  for (size_t i = 0; i < uv.size(); ++i) uv[i] = Vec2(u.dot(s.positions[i]), v.dot(s.positions[i]));
  return uv;
}

/// A single face keeps its shape; without an area it becomes a segment.
std::vector<Vec2> single_face(const Piece& piece) {
  const Surface& s = piece.surface;
  const Triangle& t = s.faces.front();
  const Vec3 e1 = s.positions[t[1]] - s.positions[t[0]], e2 = s.positions[t[2]] - s.positions[t[0]];
  const double length = e1.norm();
  std::vector<Vec2> uv(3, Vec2::Zero());
  if (length > 0.0) {
    uv[t[1]] = Vec2(length, 0.0);
    uv[t[2]] = Vec2(e1.dot(e2) / length, e1.cross(e2).norm() / length);
  }
  return uv;
}

/// Halve a region by the order in which a walk from one end reaches its faces.
void halve(const Surface& s, const std::vector<int32_t>& faces,
           std::vector<std::vector<int32_t>>& halves) {
  const Piece piece = extract_piece(s, faces, {});
  std::vector<int32_t> order{0};
  for (int sweep = 0; sweep < 2; ++sweep) {
    const int seed = order.back();
    std::vector<char> seen(faces.size(), 0);
    order.assign(1, seed);
    seen[seed] = 1;
    for (size_t at = 0; at < order.size(); ++at) {
      for (int h : piece.surface.opposite[order[at]]) {
        if (h >= 0 && !seen[h / 3]) {
          seen[h / 3] = 1;
          order.push_back(h / 3);
        }
      }
    }
  }
  std::vector<int32_t> near, far;
  for (size_t i = 0; i < order.size(); ++i) {
    (i < order.size() / 2 ? near : far).push_back(faces[order[i]]);
  }
  for (const auto* half : {&near, &far}) {
    for (auto& part : connected_parts(s, *half)) halves.push_back(std::move(part));
  }
}

}  // namespace

std::vector<Flattening> project_to_planes(const Surface& surface, const std::vector<int32_t>& faces,
                                          const FlattenOptions& options) {
  std::vector<Flattening> done;
  // Within a cone of half angle a around the normal, areas shrink by 1 .. cos(a).
  const double least_cosine = std::clamp(1.0 / options.max_area_distortion, 0.75, 0.999);
  std::vector<std::vector<int32_t>> open =
      grow_flat_regions(surface, faces, least_cosine, options.least_area);
  while (!open.empty()) {
    const std::vector<int32_t> region = std::move(open.back());
    open.pop_back();
    Flattening flat;
    flat.piece = extract_piece(surface, region, {});
    const bool single = region.size() == 1;
    flat.uv = single ? single_face(flat.piece) : projection(flat.piece);
    flat.distortion = measure(flat.piece, flat.uv, options.least_area);
    flat.valid =
        single || (flat.distortion.flipped == 0 && boundary_is_simple(flat.piece, flat.uv));
    flat.within = flat.valid && (single || flat.distortion.area <= options.max_area_distortion);
    if (flat.within) {
      done.push_back(std::move(flat));
    } else {
      halve(surface, region, open);
    }
  }
  return done;
}

}  // namespace partuv
