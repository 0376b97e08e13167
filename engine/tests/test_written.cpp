// Packing down to the last step of single precision: gutters and borders of what is written.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "check.hpp"
#include "pack/distance.hpp"
#include "pack/outline.hpp"
#include "pack/random.hpp"
#include "pack/written.hpp"
#include "partuv/repack.hpp"

namespace partuv::test {
namespace {

using namespace packing;

/// Slanted bars that together are higher than they are long, so that only gutters lie between them.
FlatMesh bars(uint64_t seed, int count) {
  Random random(seed);
  FlatMesh mesh;
  for (int bar = 0; bar < count; ++bar) {
    constexpr double length = 9.0;
    const double height = length / count * (1.05 + 0.3 * random.uniform());
    const int32_t first = static_cast<int32_t>(mesh.uv.size());
    mesh.uv.insert(mesh.uv.end(),
                   {Vec2(0, 0), Vec2(length, 0.5 * random.uniform()),
                    Vec2(length - 0.3 * random.uniform(), height), Vec2(0.2, height)});
    mesh.faces.push_back({first, first + 1, first + 2});
    mesh.faces.push_back({first, first + 2, first + 3});
    mesh.chart.insert(mesh.chart.end(), {bar, bar});
  }
  return mesh;
}

struct Reached {
  double gutter = std::numeric_limits<double>::infinity();
  double border = std::numeric_limits<double>::infinity();
};

/// In texels, over all triangles as written.
Reached measure(const FlatMesh& mesh, const Repacked& packed, int resolution) {
  Reached reached;
  auto corner = [&](size_t face, int k) {
    const size_t at = 6 * face + 2 * (k % 3);
    return Vec2(resolution * Vec2(packed.corner_uv[at], packed.corner_uv[at + 1]));
  };
  for (size_t one = 0; one < mesh.faces.size(); ++one) {
    for (int k = 0; k < 3; ++k) {
      const Segment side{corner(one, k), corner(one, k + 1)};
      reached.border =
          std::min({reached.border, side.a.minCoeff(), resolution - side.a.maxCoeff()});
      for (size_t two = 0; two < one; ++two) {
        if (mesh.chart[one] == mesh.chart[two]) continue;
        for (int j = 0; j < 3; ++j) {
          const Segment other{corner(two, j), corner(two, j + 1)};
          reached.gutter = std::min(reached.gutter, segment_distance(side, other));
        }
      }
    }
  }
  return reached;
}

/// Where charts fill a tile but for the gutters, these are what was asked for, to a few steps of
/// the coordinates, and never less. What is reported is what is written.
void test_gutter_as_written_is_the_one_asked() {
  const Context context(2);
  PackOptions options;
  options.effort = 0.1;
  for (const auto& [resolution, gutter, mips] :
       {std::tuple(1024, 4.0, 0), std::tuple(1000, 3.0, 0), std::tuple(4096, 1.5, 1),
        std::tuple(256, 2.0, 2)}) {
    options.resolution = resolution;
    options.gutter_texels = gutter;
    options.mip_levels = mips;
    const double asked = std::ldexp(gutter, mips);
    const double step = std::ldexp(resolution, -24);
    for (uint64_t seed = 0; seed < 24; ++seed) {
      const FlatMesh mesh = bars(seed, 2 + static_cast<int>(seed % 3));
      const Repacked packed = repack(mesh, options, context).value();
      const Reached reached = measure(mesh, packed, resolution);
      CHECK(reached.gutter >= asked);
      CHECK(reached.gutter < asked + 2.0 * step);
      CHECK(reached.border >= 0.5 * asked);
      CHECK(std::abs(packed.packing.tiles[0].gutter_texels - reached.gutter) < 1e-9);
    }
  }
}

/// A point right between two steps may be written as either, so nothing is said of its chart.
void test_points_between_steps_are_in_doubt() {
  PackChart square;
  square.uv = {Vec2(0, 0), Vec2(64, 0), Vec2(64, 64), Vec2(0, 64)};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Outlines outlines = make_outlines({square}, Context());
  const WrittenGrid grid{1024, 24};
  const WrittenOutlines written(outlines.charts, grid);
  Layout layout{outlines.unit, {{0.0, Vec2(100, 100)}}};
  for (const auto& [steps, known] : {std::tuple(0.0, true), std::tuple(0.499, true),
                                     std::tuple(0.5, false), std::tuple(0.501, true)}) {
    layout.poses[0].centre.x() = 100.0 + steps * grid.step_texels();
    const auto placed = written.place(layout, 2.0);
    CHECK(placed.has_value() == known);
    if (!placed) continue;
    double low = std::numeric_limits<double>::infinity();
    for (const Segment& side : placed->sides) low = std::min(low, side.a.x());
    CHECK(low == 70.0 + (steps > 0.5 ? grid.step_texels() : 0.0));
  }
}

}  // namespace
}  // namespace partuv::test

int main() {
  partuv::test::test_gutter_as_written_is_the_one_asked();
  partuv::test::test_points_between_steps_are_in_doubt();
  return partuv::test::failures > 0 ? 1 : 0;
}
