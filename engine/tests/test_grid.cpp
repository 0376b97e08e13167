// Rounding to the grid of single precision.
#include <cmath>
#include <random>

#include "check.hpp"
#include "partuv/grid.hpp"
#include "partuv/surface.hpp"
#include "planar.hpp"

namespace partuv::test {
namespace {

/// A strip of needles that a map has squeezed to less than the height of the grid.
void test_vertices_stay_near() {
  constexpr int grid_bits = 24;
  const double grid = std::ldexp(1.0, grid_bits);
  Piece piece;
  Surface& s = piece.surface;
  std::vector<Vec2> uv;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.2 + 0.01 * i, height = i % 2 == 0 ? 0.0 : (0.2 + 0.1 * (i % 7)) / grid;
    s.positions.emplace_back(x, i % 2 == 0 ? 0.0 : 12.0 / grid, 0.0);
    uv.emplace_back(x, 0.5 + height);
    if (i >= 2)
      s.faces.push_back(i % 2 == 0 ? Triangle{i - 2, i, i - 1} : Triangle{i - 2, i - 1, i});
  }
  // One wide face, so that the strip cannot dictate the scale.
  const int first = s.vertex_count();
  for (const Vec2& p : {Vec2(0.1, 0.6), Vec2(0.9, 0.6), Vec2(0.1, 0.9)}) {
    s.positions.emplace_back(p.x(), p.y(), 0.0);
    uv.push_back(p);
  }
  s.faces.push_back({first, first + 1, first + 2});
  link_opposites(s);
  const std::vector<Vec2> rounded = round_to_grid(piece, uv, 0.0, grid_bits);
  double farthest = 0.0;
  for (size_t v = 0; v < uv.size(); ++v) {
    for (int k = 0; k < 2; ++k) {
      CHECK(rounded[v][k] * grid == std::round(rounded[v][k] * grid));
      farthest = std::max(farthest, grid * std::abs(rounded[v][k] - uv[v][k]));
    }
  }
  CHECK(farthest > 1.0);   // the needles were given room
  CHECK(farthest <= 2.5);  // no more than the packer allows for
}

/// Needles from two far points to a column of points that lie less than two steps apart.
void test_no_face_is_turned_over_for_the_area_of_others() {
  constexpr int grid_bits = 24, column = 6;
  const double grid = std::ldexp(1.0, grid_bits);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> steps(0.1, 2.0);
  for (int round = 0; round < 100; ++round) {
    Piece piece;
    Surface& s = piece.surface;
    std::vector<Vec2> uv{Vec2(0.1, 0.5), Vec2(0.3, 0.5), Vec2(0.2, 0.5)};
    for (int i = 0; i < column; ++i) {
      const int last = static_cast<int>(uv.size()) - 1;
      uv.push_back(uv[last] + Vec2(0.0, steps(random) / grid));
      s.faces.push_back({0, last, last + 1});
      s.faces.push_back({1, last + 1, last});
    }
    for (const Vec2& p : uv) s.positions.emplace_back(p.x(), p.y(), 0.0);
    link_opposites(s);
    const std::vector<Vec2> rounded = round_to_grid(piece, uv, 0.0, grid_bits);
    for (const Triangle& t : s.faces) {
      CHECK(turn(uv[t[0]], uv[t[1]], uv[t[2]]) > 0.0);
      CHECK(turn(rounded[t[0]], rounded[t[1]], rounded[t[2]]) >= 0.0);
    }
  }
}

}  // namespace
}  // namespace partuv::test

int main() {
  partuv::test::test_vertices_stay_near();
  partuv::test::test_no_face_is_turned_over_for_the_area_of_others();
  return partuv::test::failures;
}
