#include "partuv/denoise.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/denoise_normals.hpp"
#include "mesh/parallel_chunks.hpp"

namespace partuv {
namespace {

/// The lines (creases and boundary edges) through each vertex, along which alone it may move.
struct Lines {
  std::vector<uint8_t> count;                ///< 3 stands for more
  std::vector<std::array<int32_t, 2>> ends;  ///< where the first two lead
};

/// Creases and boundary edges at each vertex.
Lines find_lines(const Surface& surface, double noise, const Context& context) {
  const double least_cosine = std::cos(detail::crease_angle(noise));
  const std::vector<Vec3> normal = detail::filtered_normals(surface, noise, context);
  Lines lines;
  lines.count.assign(surface.positions.size(), 0);
  lines.ends.assign(surface.positions.size(), {-1, -1});
  const auto add = [&](int v, int end) {
    if (lines.count[v] < 2) lines.ends[v][lines.count[v]] = end;
    if (lines.count[v] < 3) ++lines.count[v];
  };
  for (int f = 0; f < surface.face_count(); ++f) {
    for (int s = 0; s < 3; ++s) {
      const int h = surface.opposite[f][s];
      if (h >= 0 && (h / 3 > f || normal[f].dot(normal[h / 3]) >= least_cosine)) continue;
      const int a = surface.faces[f][s], b = surface.faces[f][(s + 1) % 3];
      add(a, b);
      add(b, a);
    }
  }
  return lines;
}

std::vector<Vec3> smooth(const Surface& surface, const std::vector<double>& strength, double noise,
                         const Context& context) {
  const int vertices = surface.vertex_count();
  const double most = *std::max_element(strength.begin(), strength.end());
  std::vector<Vec3> position = surface.positions;
  if (!(most > 0.0)) return position;
  const Lines lines = find_lines(surface, noise, context);
  // A line that turns by more than this at a vertex has a corner there.
  constexpr double corner_cosine = 0.7;

  std::vector<int32_t> begin(vertices + 1, 0);
  for (const Triangle& t : surface.faces) {
    for (const int v : t) ++begin[v + 1];
  }
  for (int v = 0; v < vertices; ++v) begin[v + 1] += begin[v];
  std::vector<int32_t> neighbour(begin.back());
  std::vector<int32_t> at(begin.begin(), begin.end() - 1);
  for (const Triangle& t : surface.faces) {
    for (int s = 0; s < 3; ++s) neighbour[at[t[s]]++] = t[(s + 1) % 3];
  }

  std::vector<Vec3> next = position;
  const int passes = static_cast<int>(std::ceil(most));
  for (int pass = 0; pass < passes && !context.cancelled(); ++pass) {
    detail::parallel_chunks(context, vertices, [&](int v) {
      next[v] = position[v];
      const double step = 0.5 * strength[v] / passes;
      if (!(step > 0.0) || lines.count[v] == 1 || lines.count[v] > 2) return;
      Vec3 target = Vec3::Zero();
      if (lines.count[v] == 2) {
        const Vec3& a = position[lines.ends[v][0]];
        const Vec3& b = position[lines.ends[v][1]];
        const Vec3 in = position[v] - a, out = b - position[v];
        if (in.dot(out) < corner_cosine * in.norm() * out.norm()) return;
        target = 0.5 * (a + b);
      } else {
        // Inside the surface each neighbour follows v in exactly one face.
        for (int i = begin[v]; i < begin[v + 1]; ++i) target += position[neighbour[i]];
        target /= begin[v + 1] - begin[v];
      }
      next[v] += step * (target - position[v]);
    });
    position.swap(next);
  }
  return position;
}

}  // namespace

std::vector<Vec3> denoise(const Surface& surface, double strength, const Context& context) {
  if (surface.positions.empty()) return {};
  const std::vector<double> everywhere(surface.positions.size(), std::max(0.0, strength));
  return smooth(surface, everywhere, estimate_noise(surface), context);
}

std::vector<Vec3> denoise_auto(const Surface& surface, const Noise& noise, const Context& context) {
  if (surface.positions.empty()) return {};
  std::vector<double> strength(surface.positions.size(), 0.0);
  double area_noise = 0.0, area = 0.0;
  for (int f = 0; f < surface.face_count(); ++f) {
    const double own_noise = noise.of_component[noise.component[f]];
    const double own = strength_for_noise(own_noise);
    for (const int v : surface.faces[f]) strength[v] = own;
    const double face_area = face_cross(surface, f).norm();
    area += face_area;
    area_noise += face_area * own_noise;
  }
  return smooth(surface, strength, area > 0.0 ? area_noise / area : 0.0, context);
}

}  // namespace partuv
