// Packing: gutter, border, determinism and deadlines on charts of many kinds.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

#include "check.hpp"
#include "pack/distance.hpp"
#include "pack/orient.hpp"
#include "pack/outline.hpp"
#include "pack/random.hpp"
#include "partuv/pack.hpp"

namespace partuv::test {
namespace {

using packing::Random;
using packing::Segment;

/// A fan of triangles around the origin with the given radii.
PackChart star(const std::vector<double>& radii) {
  PackChart chart;
  chart.uv.push_back(Vec2::Zero());
  const int n = static_cast<int>(radii.size());
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / n;
    chart.uv.push_back(radii[i] * Vec2(std::cos(angle), std::sin(angle)));
    chart.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  return chart;
}

PackChart disk(double radius) { return star(std::vector<double>(32, radius)); }

/// A ring from `inner` to `outer`: its hole is to be used.
PackChart ring(double inner, double outer) {
  PackChart chart;
  constexpr int n = 48;
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / n;
    const Vec2 direction(std::cos(angle), std::sin(angle));
    chart.uv.push_back(inner * direction);
    chart.uv.push_back(outer * direction);
    const int a = 2 * i, b = 2 * ((i + 1) % n);
    chart.triangles.push_back({a, a + 1, b + 1});
    chart.triangles.push_back({a, b + 1, b});
  }
  return chart;
}

PackChart rectangle(double width, double height) {
  PackChart chart;
  chart.uv = {Vec2(0, 0), Vec2(width, 0), Vec2(width, height), Vec2(0, height)};
  chart.triangles = {{0, 1, 2}, {0, 2, 3}};
  return chart;
}

std::vector<PackChart> random_charts(uint64_t seed, int count) {
  Random random(seed);
  std::vector<PackChart> charts;
  for (int i = 0; i < count; ++i) {
    const double size = std::exp(2.5 * random.uniform());
    if (random.below(8) == 0) {
      charts.push_back(rectangle(8.0 * size, 0.02 * size));
      continue;
    }
    std::vector<double> radii(5 + random.below(40));
    for (double& radius : radii) radius = size * (0.3 + random.uniform());
    charts.push_back(star(radii));
    const Vec2 away(1e3 * random.uniform(), -50.0);
    for (Vec2& p : charts.back().uv) p += away;
  }
  return charts;
}

struct Measured {
  double gutter = std::numeric_limits<double>::infinity();  // texels
  double border = std::numeric_limits<double>::infinity();  // texels
  double area = 0.0;                                        // of the unit square
};

/// All triangles as written, on the 2^-24 grid, compared pair by pair.
Measured measure(const std::vector<PackChart>& charts, const Packing& packing, int resolution) {
  Measured measured;
  std::vector<std::vector<Segment>> sides(charts.size());
  std::vector<std::vector<std::array<Vec2, 3>>> triangles(charts.size());
  std::vector<Vec2> low(charts.size()), high(charts.size());
  for (size_t c = 0; c < charts.size(); ++c) {
    const Placement& at = packing.placements[c];
    const double cosine = at.scale * std::cos(at.rotation_rad);
    const double sine = at.scale * std::sin(at.rotation_rad);
    low[c] = Vec2::Constant(INFINITY);
    high[c] = Vec2::Constant(-INFINITY);
    for (const Triangle& t : charts[c].triangles) {
      std::array<Vec2, 3> corner;
      for (int k = 0; k < 3; ++k) {
        const Vec2& p = charts[c].uv[t[k]];
        const Vec2 q = Vec2(cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y());
        corner[k] = ((q + at.offset) * 0x1p24).array().round() * 0x1p-24 * resolution;
        measured.border =
            std::min({measured.border, corner[k].minCoeff(), resolution - corner[k].maxCoeff()});
        low[c] = low[c].cwiseMin(corner[k]);
        high[c] = high[c].cwiseMax(corner[k]);
      }
      for (int k = 0; k < 3; ++k) sides[c].push_back({corner[k], corner[(k + 1) % 3]});
      const Vec2 u = corner[1] - corner[0], v = corner[2] - corner[0];
      measured.area += 0.5 * (u.x() * v.y() - u.y() * v.x()) / resolution / resolution;
      triangles[c].push_back(corner);
    }
  }
  auto holds = [](const std::array<Vec2, 3>& t, const Vec2& p) {
    for (int k = 0; k < 3; ++k) {
      const Vec2 u = t[(k + 1) % 3] - t[k], v = p - t[k];
      if (u.x() * v.y() - u.y() * v.x() <= 0.0) return false;
    }
    return true;
  };
  for (size_t a = 0; a < charts.size(); ++a) {
    for (size_t b = a + 1; b < charts.size(); ++b) {
      const double reach = std::min(measured.gutter, 1e3);
      if ((low[a] - high[b]).maxCoeff() > reach || (low[b] - high[a]).maxCoeff() > reach) continue;
      for (const Segment& one : sides[a]) {
        for (const Segment& two : sides[b]) {
          measured.gutter = std::min(measured.gutter, packing::segment_distance(one, two));
        }
      }
      for (const auto& t : triangles[a]) {
        if (holds(t, sides[b][0].a)) measured.gutter = 0.0;
      }
      for (const auto& t : triangles[b]) {
        if (holds(t, sides[a][0].a)) measured.gutter = 0.0;
      }
    }
  }
  return measured;
}

bool same(const Packing& one, const Packing& two) {
  if (one.placements.size() != two.placements.size()) return false;
  for (size_t i = 0; i < one.placements.size(); ++i) {
    const Placement& a = one.placements[i];
    const Placement& b = two.placements[i];
    if (a.rotation_rad != b.rotation_rad || a.scale != b.scale || a.offset != b.offset ||
        a.tile != b.tile) {
      return false;
    }
  }
  return true;
}

/// The options of most tests: every stage of the packer at work, a tenth of the time.
PackOptions little_effort() {
  PackOptions options;
  options.effort = 0.1;
  return options;
}

void test_gutter_holds() {
  for (const auto& [seed, count, resolution, gutter] :
       {std::tuple(1, 2, 1024, 4.0), std::tuple(2, 12, 1024, 4.0), std::tuple(3, 30, 256, 8.0),
        std::tuple(4, 60, 4096, 1.0), std::tuple(5, 120, 512, 0.0), std::tuple(6, 40, 64, 2.0)}) {
    const std::vector<PackChart> charts = random_charts(seed, count);
    PackOptions options = little_effort();
    options.resolution = resolution;
    options.gutter_texels = gutter;
    Context context(2);
    const Packing packing = pack(charts, options, context).value();
    const Measured measured = measure(charts, packing, resolution);
    CHECK(measured.gutter >= gutter);
    CHECK(measured.border >= 0.5 * gutter);
    CHECK(packing.efficiency > 0.0 && packing.efficiency <= 1.0);
    for (const Placement& at : packing.placements) {
      CHECK(at.scale == packing.placements[0].scale);
      CHECK(at.tile == 0);
    }
  }
}

void test_threads_do_not_matter() {
  for (const int count : {1, 7, 40, 260}) {
    const std::vector<PackChart> charts = random_charts(11, count);
    Context one(1), two(2), five(5);
    const Packing first = pack(charts, little_effort(), one).value();
    CHECK(same(first, pack(charts, little_effort(), two).value()));
    CHECK(same(first, pack(charts, little_effort(), five).value()));
  }
}

void test_holes_are_used() {
  std::vector<PackChart> charts{ring(8.0, 10.0)};
  for (int i = 0; i < 4; ++i) charts.push_back(disk(2.5));
  Context context(2);
  const Packing packing = pack(charts, PackOptions{}, context).value();
  // Next to the ring the disks would leave it less than this share of the side.
  const double across = 20.0 * packing.placements[0].scale;
  CHECK(across > 0.97);
}

void test_known_best_packings() {
  Context context(2);
  PackOptions tight;
  tight.gutter_texels = 0.0;
  CHECK(pack({rectangle(1, 1)}, tight, context).value().efficiency > 0.999);
  std::vector<PackChart> squares(9, rectangle(1, 1));
  for (size_t i = 0; i < squares.size(); ++i) {
    const double turn = 0.3 * static_cast<double>(i);
    for (Vec2& p : squares[i].uv) {
      p = Vec2(std::cos(turn) * p.x() - std::sin(turn) * p.y(),
               std::sin(turn) * p.x() + std::cos(turn) * p.y());
    }
  }
  CHECK(pack(squares, tight, context).value().efficiency > 0.97);
}

void test_long_charts_lie_across() {
  PackChart wedge;  // it is longer than the square's side, and no turn by 45 degrees is the best
  wedge.uv = {Vec2(0, 0), Vec2(20, 0), Vec2(20, 5), Vec2(0, 11)};
  wedge.triangles = {{0, 1, 2}, {0, 2, 3}};
  std::vector<PackChart> charts{wedge};
  for (int i = 0; i < 10; ++i) charts.push_back(rectangle(2.2 + 0.06 * i, 2.2));
  Context context(2);
  const Packing packing = pack(charts, PackOptions{}, context).value();
  const double least_square = packing::least_square(packing::convex_hull(wedge.uv)).size.maxCoeff();
  CHECK(least_square * packing.placements[0].scale > 0.998 * 1020.0 / 1024.0);  // was 0.982
}

void test_effort_pays() {
  const auto efficiency = [](double effort) {
    double sum = 0.0;
    for (uint64_t seed = 20; seed < 24; ++seed) {
      Context context(2);
      PackOptions options;
      options.effort = effort;
      sum += pack(random_charts(seed, 15), options, context).value().efficiency;
    }
    return sum;
  };
  const double none = efficiency(0.0), little = efficiency(0.02), standard = efficiency(1.0);
  CHECK(little > 1.02 * none);
  CHECK(standard > 1.02 * little);
  CHECK(standard > 1.05 * none);
}

void test_degenerate_charts() {
  PackChart empty;
  PackChart point;
  point.uv = {Vec2(3, 3), Vec2(3, 3), Vec2(3, 3)};
  point.triangles = {{0, 1, 2}};
  PackChart line;
  line.uv = {Vec2(0, 0), Vec2(1, 1), Vec2(2, 2)};
  line.triangles = {{0, 1, 2}};
  Context context(2);
  for (const auto& charts : {std::vector<PackChart>{},
                             {empty},
                             {point},
                             {line},
                             {empty, point, line, disk(1.0)},
                             std::vector<PackChart>(50, point)}) {
    const Packing packing = pack(charts, PackOptions{}, context).value();
    CHECK(packing.placements.size() == charts.size());
    for (const Placement& at : packing.placements) {
      CHECK(std::isfinite(at.scale) && at.scale > 0.0 && at.offset.allFinite());
    }
    const Measured measured = measure(charts, packing, 1024);
    CHECK(measured.gutter >= 4.0);
    CHECK(measured.border >= 2.0);
  }
}

using Clock = std::chrono::steady_clock;

/// Triangles of both windings on top of each other, as where a leaf is drawn from both sides.
PackChart crumpled(Random& random, double size, int triangles) {
  PackChart chart;
  for (int i = 0; i < triangles / 3; ++i) {
    chart.uv.push_back(size * Vec2(random.uniform(), random.uniform()));
  }
  const int points = static_cast<int>(chart.uv.size());
  for (int i = 0; i < triangles; ++i) {
    chart.triangles.push_back({random.below(points), random.below(points), random.below(points)});
  }
  return chart;
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Charts smaller than the gutter, each of many sides, lie within reach of each other by the dozen.
/// That once took minutes, under the sanitizers longer than a test may run.
void test_crumbs_cost_little() {
  Random random(41);
  std::vector<PackChart> charts{rectangle(392, 392), rectangle(70, 70)};
  for (int i = 0; i < 66; ++i) charts.push_back(crumpled(random, 1.1, 98));
  Context context(2);
  const Packing packing = pack(charts, PackOptions{}, context).value();
  CHECK(measure(charts, packing, 1024).gutter >= 4.0);
}

void test_deadline_and_cancel() {
  const std::vector<PackChart> charts = random_charts(31, 150);
  PackOptions options;
  options.effort = 1000.0;
  constexpr double far_from_done_s = 30.0;  // of the many minutes that this effort would take
  {
    Context context(2, 0.2);
    const Clock::time_point start = Clock::now();
    const Packing packing = pack(charts, options, context).value();
    CHECK(seconds_since(start) < far_from_done_s);
    CHECK(measure(charts, packing, 1024).gutter >= 4.0);
  }
  {
    Context context(2);
    std::thread other([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      context.cancel();
    });
    const Clock::time_point start = Clock::now();
    pack(charts, options, context);
    CHECK(seconds_since(start) < far_from_done_s);
    other.join();
  }
  {
    Context context(2, 0.0);
    CHECK(measure(charts, pack(charts, options, context).value(), 1024).gutter >= 4.0);
  }
}

}  // namespace
}  // namespace partuv::test

int main() {
  partuv::test::test_gutter_holds();
  partuv::test::test_threads_do_not_matter();
  partuv::test::test_holes_are_used();
  partuv::test::test_known_best_packings();
  partuv::test::test_long_charts_lie_across();
  partuv::test::test_effort_pays();
  partuv::test::test_degenerate_charts();
  partuv::test::test_crumbs_cost_little();
  partuv::test::test_deadline_and_cancel();
  return partuv::test::failures > 0 ? 1 : 0;
}
