// The derivatives that Newton's steps are made of, against differences of the energy.
#include <cmath>

#include "check.hpp"
#include "flatten/newton.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

/// A curved sheet, and a map of it that distorts every face in another way.
struct Sheet {
  Piece piece;
  std::vector<RestTriangle> rest;
  std::vector<Vec2> uv;

  explicit Sheet(int side) {
    Surface& s = piece.surface;
    for (int y = 0; y <= side; ++y) {
      for (int x = 0; x <= side; ++x) {
        s.positions.emplace_back(x, y, 0.1 * std::sin(0.9 * x) * std::cos(0.7 * y));
        uv.emplace_back(1.1 * x + 0.05 * std::sin(1.3 * y), y + 0.05 * std::cos(0.8 * x));
      }
    }
    const int row = side + 1;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const int v = y * row + x;
        s.faces.push_back({v, v + 1, v + row + 1});
        s.faces.push_back({v, v + row + 1, v + row});
      }
    }
    piece.weight.assign(s.faces.size(), 1.0);
    rest = rest_shapes(s);
  }
};

/// Slope and bend of the energy along the step, by differences and as the step claims.
void test_derivatives(Sheet sheet, double epsilon, bool convex) {
  MeshSystem<2> system(sheet.piece.surface.faces, sheet.piece.surface.vertex_count());
  const PolishOptions options;
  const Context context;
  Newton newton(sheet.piece, sheet.rest, options, context, system);
  std::vector<Vec2> step(sheet.uv.size());
  const double slope = newton.direction(sheet.uv, epsilon, step);
  CHECK(slope < 0.0);
  const auto energy_at = [&](double length) {
    std::vector<Vec2> uv = sheet.uv;
    for (size_t v = 0; v < uv.size(); ++v) uv[v] += length * step[v];
    return newton.energy(uv, epsilon);
  };
  constexpr double h = 1e-5;
  const double ahead = energy_at(h), here = energy_at(0.0), behind = energy_at(-h);
  CHECK(std::abs((ahead - behind) / (2.0 * h) - slope) <= 1e-4 * std::abs(slope));
  // Along a Newton step the energy bends as much as it slopes, if no eigenvalue was dropped.
  const double bend = (ahead - 2.0 * here + behind) / (h * h);
  CHECK(!convex || std::abs(bend + slope) <= 1e-3 * std::abs(slope));
}

/// Elements are evaluated side by side; the step is to the bit the same as by one thread.
void test_threads() {
  Sheet sheet(40);
  std::vector<std::vector<Vec2>> steps;
  for (const int threads : {1, 4}) {
    MeshSystem<2> system(sheet.piece.surface.faces, sheet.piece.surface.vertex_count());
    const PolishOptions options;
    const Context context(threads);
    Newton newton(sheet.piece, sheet.rest, options, context, system);
    steps.emplace_back(sheet.uv.size());
    CHECK(newton.direction(sheet.uv, 0.0, steps.back()) < 0.0);
  }
  CHECK(steps[0] == steps[1]);
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  // More faces than fill one batch of elements, and not a whole number of batches.
  const Sheet sheet(7);
  test_derivatives(sheet, 0.0, true);
  test_derivatives(sheet, 0.05, true);
  Sheet flipped = sheet;
  flipped.uv[3 * 8 + 3] += partuv::Vec2(2.5, 2.0);
  test_derivatives(flipped, 0.05, false);
  test_threads();
  return failures;
}
