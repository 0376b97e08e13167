// The last steps of packing: charts that are caught, gutters that are used up, sums by lanes.
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "check.hpp"
#include "pack/distance.hpp"
#include "pack/outline.hpp"
#include "pack/polish.hpp"
#include "pack/random.hpp"
#include "pack/sums.hpp"
#include "partuv/repack.hpp"

namespace partuv::test {
namespace {

using namespace packing;

PackChart rectangle(double width, double height) {
  PackChart chart;
  chart.uv = {Vec2(0, 0), Vec2(width, 0), Vec2(width, height), Vec2(0, height)};
  chart.triangles = {{0, 1, 2}, {0, 2, 3}};
  return chart;
}

/// Four bars around a square hole, as one chart.
PackChart frame(double inner, double outer) {
  PackChart chart;
  for (const double half : {0.5 * inner, 0.5 * outer}) {
    for (const Vec2& corner : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)}) {
      chart.uv.push_back(half * corner);
    }
  }
  for (int i = 0; i < 4; ++i) {
    const int next = (i + 1) % 4;
    chart.triangles.push_back({i, 4 + i, 4 + next});
    chart.triangles.push_back({i, 4 + next, next});
  }
  return chart;
}

/// A square in a hole that is too small for it with the gutter, with room outside of the frame.
void test_caught_charts_are_put_elsewhere() {
  const Outlines outlines = make_outlines(
      {frame(60, 200), rectangle(56, 56), rectangle(90, 90), rectangle(90, 90)}, Context());
  const Bin bin{512.0, 4.0, 0.0};
  const double unit = 1.0 / outlines.unit;
  const Layout start{
      outlines.unit,
      {{0.0, Vec2(102, 102)}, {0.0, Vec2(102, 102)}, {0.0, Vec2(300, 60)}, {0.0, Vec2(300, 160)}}};
  const Context context(1);
  const Polisher polisher(outlines.charts, bin, 1.0 / unit, true);
  Layout stays = start;
  const Pushed pushed = polisher.tighten(stays, 20, Caught::fail, context);
  CHECK(stays.scale == 0.0);
  CHECK(pushed.caught == std::vector<int>{1});
  Layout moves = start;
  CHECK(polisher.tighten(moves, 20, Caught::move_elsewhere, context).caught.empty());
  CHECK(moves.scale > start.scale);
  CHECK((moves.poses[1].centre - moves.poses[0].centre).norm() > 100.0);
  polisher.settle(moves, context);
  CHECK(moves.scale > start.scale);
}

/// What is packed by tightening ends with hardly more than the gutter between its charts.
void test_gutter_is_used_up() {
  std::vector<PackChart> charts;
  for (int i = 0; i < 12; ++i) {
    charts.push_back(rectangle(3.0 + 0.3 * i, 2.0));
    charts.back().uv[2].x() -= 1.0;
  }
  PackOptions options;
  options.effort = 0.1;
  const Context context(2);
  const double gutter = pack(charts, options, context).value().tiles[0].gutter_texels;
  CHECK(gutter >= 4.0);
  CHECK(gutter < 4.0001);  // was 4.03
}

/// Three bars fill a tile but for the gutters between them, as written.
void test_repacked_bars() {
  FlatMesh mesh;
  for (int bar = 0; bar < 3; ++bar) {
    const PackChart chart = rectangle(9, 3);
    const int first = static_cast<int>(mesh.uv.size());
    mesh.uv.insert(mesh.uv.end(), chart.uv.begin(), chart.uv.end());
    for (const Triangle& t : chart.triangles) {
      mesh.faces.push_back({first + t[0], first + t[1], first + t[2]});
      mesh.chart.push_back(bar);
    }
  }
  const Context context(1);
  const Repacked repacked = repack(mesh, PackOptions{}, context).value();
  double low[3], high[3];
  for (int bar = 0; bar < 3; ++bar) {
    low[bar] = 1.0;
    high[bar] = 0.0;
    const bool upright = std::abs(std::sin(repacked.packing.placements[bar].rotation_rad)) > 0.5;
    for (int corner = 6 * bar; corner < 6 * bar + 6; ++corner) {
      const double at = repacked.corner_uv[2 * corner + (upright ? 0 : 1)];
      low[bar] = std::min(low[bar], at);
      high[bar] = std::max(high[bar], at);
    }
  }
  double gap = 1.0;
  for (int one = 0; one < 3; ++one) {
    for (int two = 0; two < 3; ++two) {
      if (low[two] > high[one]) gap = std::min(gap, low[two] - high[one]);
    }
  }
  CHECK(1024.0 * gap >= 4.0);
  CHECK(1024.0 * gap < 4.0001);
}

/// Lanes of sums are what adding one by one gives, for any number of them.
void test_sums() {
  Random random(3);
  for (int count = 1; count < 40; ++count) {
    std::vector<uint32_t> line(200), plain(200);
    for (uint32_t& value : line) value = static_cast<uint32_t>(random.below(1000));
    const std::vector<Strip> strips{{&line[3], &line[20]}, {&line[40], &line[41]}};
    std::vector<uint32_t> sums(count + lane_count, 7);
    uint32_t lowest = std::numeric_limits<uint32_t>::max();
    const uint32_t found = add_strips(sums.data(), strips.data(), 2, 5, count, count % 2 == 0);
    for (int x = 0; x < count; ++x) {
      const uint32_t before = count % 2 == 0 ? 0 : 7;
      plain[x] = before + line[25 + x] - line[8 + x] + line[46 + x] - line[45 + x];
      CHECK(sums[x] == plain[x]);
      lowest = std::min(lowest, plain[x]);
    }
    CHECK(found == lowest);
  }
  constexpr int cells = 9, rows = 2 * lane_count;
  std::vector<uint32_t> block(cells * rows);
  for (uint32_t& value : block) value = static_cast<uint32_t>(random.below(100));
  std::vector<std::vector<uint32_t>> single(rows, std::vector<uint32_t>(cells));
  for (int i = 0; i < cells * rows; ++i) single[i % rows][i / rows] = block[i];
  sum_rows_twice(block.data(), cells, rows);
  for (int row = 0; row < rows; ++row) {
    sum_twice(single[row].data(), cells);
    for (int x = 0; x < cells; ++x) CHECK(single[row][x] == block[x * rows + row]);
  }
  std::vector<uint32_t> changes{1, 0, 2, 0};
  sum_twice(changes.data(), 4);
  CHECK((changes == std::vector<uint32_t>{0, 1, 2, 5}));
}

}  // namespace
}  // namespace partuv::test

int main() {
  partuv::test::test_caught_charts_are_put_elsewhere();
  partuv::test::test_gutter_is_used_up();
  partuv::test::test_repacked_bars();
  partuv::test::test_sums();
  return partuv::test::failures > 0 ? 1 : 0;
}
