#include "single_precision.hpp"

#include <algorithm>

#include "planar.hpp"

namespace partuv {
namespace {

void enlarge_speck(std::vector<Vec2>& uv) {
  constexpr double least_extent = 1e-4;
  Vec2 low = uv.front(), high = low;
  for (const Vec2& p : uv) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double extent = (high - low).maxCoeff();
  if (!(extent > 0.0) || extent >= least_extent) return;
  for (Vec2& p : uv) p = (p - low) * (least_extent / extent);
}

/// Lift the apex of a lone face over its longest side.
void thicken_needle(const Triangle& face, std::vector<Vec2>& uv) {
  constexpr double least_height = 2e-6;  // some dozen steps of the grid
  const auto side = [&](int k) -> Vec2 { return uv[face[(k + 1) % 3]] - uv[face[k]]; };
  int base = 0;
  for (int k = 1; k < 3; ++k) {
    if (side(k).norm() > side(base).norm()) base = k;
  }
  const double length = side(base).norm();
  if (!(length > 0.0)) return;
  const Vec2 &from = uv[face[base]], &to = uv[face[(base + 1) % 3]];
  Vec2& apex = uv[face[(base + 2) % 3]];
  if (turn(from, to, apex) >= least_height * length) return;
  const Vec2 along = side(base) / length;
  apex = from + along * along.dot(apex - from) + least_height * Vec2(-along.y(), along.x());
}

}  // namespace

void fit_to_single_precision(std::vector<SolvedChart>& solved) {
  for (SolvedChart& chart : solved) {
    const std::vector<Triangle>& faces = chart.flattening.piece.surface.faces;
    enlarge_speck(chart.flattening.uv);
    if (faces.size() == 1) thicken_needle(faces.front(), chart.flattening.uv);
  }
}

}  // namespace partuv
