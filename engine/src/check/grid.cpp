#include "partuv/grid.hpp"

#include <algorithm>
#include <cmath>

#include "partuv/flatten.hpp"
#include "planar.hpp"

namespace partuv {
namespace {

/// Penalty of a face: max(s, 1/s) clipped as in the paper; where it is turned over, more than
/// all that others could gain by it.
double penalty(double area_2d, double wanted) {
  if (!(area_2d > 0.0)) return area_2d < 0.0 ? 1000.0 : most_face_distortion;
  return std::min(std::max(area_2d / wanted, wanted / area_2d), most_face_distortion);
}

}  // namespace

std::vector<Vec2> round_to_grid(const Piece& piece, const std::vector<Vec2>& uv, double least_area,
                                int grid_bits) {
  const double grid = std::ldexp(1.0, grid_bits);
  constexpr int passes = 3;
  constexpr int reach = 2;      // grid steps that a vertex may move; rounding adds half a step
  constexpr double poor = 1.5;  // penalty from which a face is looked at
  const Surface& s = piece.surface;
  std::vector<Vec2> rounded(uv.size());
  for (size_t v = 0; v < uv.size(); ++v) {
    for (int k = 0; k < 2; ++k) {
      rounded[v][k] = std::clamp(std::round(uv[v][k] * grid) / grid, 0.0, 1.0);
    }
  }
  double sum_3d = 0.0, sum_2d = 0.0;
  std::vector<double> area_3d(s.faces.size());
  for (int f = 0; f < s.face_count(); ++f) {
    const Triangle& t = s.faces[f];
    area_3d[f] = 0.5 * face_cross(s, f).norm();
    if (area_3d[f] <= least_area) continue;
    sum_3d += area_3d[f];
    sum_2d += std::abs(0.5 * turn(uv[t[0]], uv[t[1]], uv[t[2]]));
  }
  if (!(sum_2d > 0.0)) return rounded;
  const double scale = sum_2d / sum_3d;
  auto face_penalty = [&](int f) {
    if (area_3d[f] <= least_area) return 0.0;
    const Triangle& t = s.faces[f];
    return penalty(0.5 * turn(rounded[t[0]], rounded[t[1]], rounded[t[2]]), area_3d[f] * scale);
  };
  // Only faces that rounding can harm: no more than a few grid steps high.
  auto harmed = [&](int f) {
    if (area_3d[f] <= least_area) return false;
    const Triangle& t = s.faces[f];
    const double longest = longest_side(uv[t[0]], uv[t[1]], uv[t[2]]);
    return 2.0 * area_3d[f] * scale < 16.0 / grid * longest && face_penalty(f) > poor;
  };
  std::vector<std::vector<int32_t>> around;
  for (int pass = 0; pass < passes; ++pass) {
    bool moved = false;
    for (int f = 0; f < s.face_count(); ++f) {
      if (!harmed(f)) continue;
      if (around.empty()) {
        around.resize(uv.size());
        for (int g = 0; g < s.face_count(); ++g) {
          for (int v : s.faces[g]) around[v].push_back(g);
        }
      }
      for (int v : s.faces[f]) {
        const Vec2 start = rounded[v];
        Vec2 best = start;
        auto cost = [&] {
          double sum = 0.0;
          for (int g : around[v]) sum += face_penalty(g);
          return sum;
        };
        double least = cost();
        for (int y = -reach; y <= reach; ++y) {
          for (int x = -reach; x <= reach; ++x) {
            rounded[v] = start + Vec2(x, y) / grid;
            if (rounded[v].minCoeff() < 0.0 || rounded[v].maxCoeff() > 1.0) continue;
            if ((rounded[v] - uv[v]).cwiseAbs().maxCoeff() * grid > reach + 0.5) continue;
            const double c = cost();
            if (c < least - 1e-9) {
              least = c;
              best = rounded[v];
            }
          }
        }
        rounded[v] = best;
        moved = moved || best != start;
      }
    }
    if (!moved) break;
  }
  return rounded;
}

}  // namespace partuv
