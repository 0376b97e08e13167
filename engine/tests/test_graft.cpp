// Charts that are laid on neighbouring ones.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "charts.hpp"
#include "check.hpp"
#include "partuv/flatten.hpp"
#include "partuv/solve.hpp"
#include "segment/graft.hpp"
#include "segment/thin.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

void test_a_fragment_grows_onto_its_neighbour() {
  const Surface s = surface_of(sheet(10, 10));
  // A corner of the sheet is the fragment.
  Vec3 low = s.positions.front();
  for (const Vec3& p : s.positions) low = low.cwiseMin(p);
  std::vector<int32_t> host, corner;
  for (int f = 0; f < s.face_count(); ++f) {
    const Vec3 p = s.positions[s.faces[f][0]];
    (p.x() < low.x() + 0.3 && p.y() < low.y() + 0.3 ? corner : host).push_back(f);
  }
  SearchOptions options;
  std::vector<SolvedChart> charts;
  for (const auto* faces : {&host, &corner}) {
    Piece piece = extract_piece(s, *faces, {});
    std::vector<Vec2> uv = plan(piece);
    if (faces == &corner) {
      for (Vec2& p : uv) p = Vec2(-p.y(), p.x()) + Vec2(7.0, 3.0);
    }
    charts.push_back({judged(std::move(piece), std::move(uv), options.flatten), 4});
  }
  std::vector<ChartState> states{ChartState::settled, ChartState::fragment};
  graft_fragments(s, options, Context{}, charts, states);
  CHECK(charts.size() == 1 && states.size() == 1);
  CHECK(states.front() == ChartState::changed);
  const Flattening& flat = charts.front().flattening;
  CHECK(flat.within && flat.piece.surface.face_count() == s.face_count());
  CHECK(flat.distortion.area < 1.001 && flat.distortion.angular > 0.999);
}

/// A floor and a wall, each of three faces, and a face of that size in the corner between them that
/// stands upright on both.
Mesh corner(double size) {
  Mesh mesh;
  mesh.positions = {Vec3(0, 0, 0), Vec3(size, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0),
                    Vec3(0, 1, 0), Vec3(0, 0, size), Vec3(0, 0, 1), Vec3(0, 1, 1)};
  mesh.faces = {{0, 1, 4}, {1, 2, 3}, {1, 3, 4}, {0, 4, 5}, {5, 4, 7}, {5, 7, 6}, {1, 0, 5}};
  return mesh;
}

/// Floor and wall side by side in the plane as one chart, the corner as another.
std::vector<SolvedChart> unrolled_corner(const Surface& s, const FlattenOptions& options) {
  Vec3 low = s.positions.front();
  for (const Vec3& p : s.positions) low = low.cwiseMin(p);
  std::vector<int32_t> host, upright;
  for (int f = 0; f < s.face_count(); ++f) {
    const Vec3 n = face_cross(s, f).normalized();
    (std::abs(n.y()) > 0.5 ? upright : host).push_back(f);
  }
  std::vector<SolvedChart> charts;
  for (const auto* faces : {&host, &upright}) {
    Piece piece = extract_piece(s, *faces, {});
    std::vector<Vec2> uv;
    for (const Vec3& point : piece.surface.positions) {
      const Vec3 p = point - low;
      uv.push_back(faces == &host ? Vec2(p.x() - p.z(), p.y()) : Vec2(p.z(), p.x()));
    }
    charts.push_back({judged(std::move(piece), std::move(uv), options), 0});
    CHECK(charts.back().flattening.within);
  }
  return charts;
}

void test_a_chart_hangs_on_by_a_side() {
  SearchOptions options;
  options.flatten.max_area_distortion = 1.0001;  // what hung on by both would not hold it
  options.flatten.min_angular = 0.9999;
  for (const double size : {0.004, 0.5}) {
    const Surface s = surface_of(corner(size));
    std::vector<SolvedChart> charts = unrolled_corner(s, options.flatten);
    CHECK(charts.front().flattening.distortion.area < 1.0001);
    hang_small_charts(s, options, Context{}, charts);
    CHECK(charts.size() == 1);
    for (const SolvedChart& chart : charts) {
      CHECK(chart.flattening.within && chart.flattening.distortion.area < 1.0001);
    }
    CHECK(charts.front().flattening.piece.surface.face_count() == s.face_count());
  }
}

void test_small_charts_hang_and_large_ones_do_not() {
  SearchOptions options;
  for (const auto& [width, left] : {std::pair(0.2, 1), std::pair(0.3, 2)}) {
    const Surface s = surface_of(sheet(10, 10));
    const auto is_left = [](const Vec3& p, const Vec3& q) { return p.x() < q.x(); };
    const double low = std::min_element(s.positions.begin(), s.positions.end(), is_left)->x();
    std::vector<int32_t> strip, rest;
    for (int f = 0; f < s.face_count(); ++f) {
      double middle = -low;
      for (const int v : s.faces[f]) middle += s.positions[v].x() / 3.0;
      (middle < width ? strip : rest).push_back(f);
    }
    std::vector<SolvedChart> charts{flat_chart(s, strip, options.flatten),
                                    flat_chart(s, rest, options.flatten)};
    hang_small_charts(s, options, Context{}, charts);
    CHECK(static_cast<int>(charts.size()) == left);
  }
}

/// A key: a strip of two faces, its end on a short side of a hexagon of less area; and a square
/// that makes up nearly all of the area.
Mesh key() {
  Mesh mesh;
  mesh.positions = {Vec3(-0.3, 0, 0),     Vec3(-0.3, 0.002, 0), Vec3(0, 0, 0),
                    Vec3(0, 0.002, 0),    Vec3(0.01, -0.01, 0), Vec3(0.02, -0.005, 0),
                    Vec3(0.02, 0.007, 0), Vec3(0.01, 0.012, 0), Vec3(0.01, 0.001, 0),
                    Vec3(5, 5, 0),        Vec3(6, 5, 0),        Vec3(6, 6, 0),
                    Vec3(5, 6, 0)};
  mesh.faces = {{0, 2, 3}, {0, 3, 1}, {8, 3, 2}, {8, 2, 4},   {8, 4, 5},
                {8, 5, 6}, {8, 6, 7}, {8, 7, 3}, {9, 10, 11}, {9, 11, 12}};
  return mesh;
}

void test_a_sliver_hangs_on_a_chart_of_less_area() {
  const Surface s = surface_of(key());
  std::vector<std::vector<int32_t>> faces(3);
  for (int f = 0; f < s.face_count(); ++f) {
    double length = 0.0;
    for (int k = 0; k < 3; ++k) length = std::max(length, side_length(s, 3 * f + k));
    faces[length > 1.0 ? 2 : length > 0.1 ? 0 : 1].push_back(f);
  }
  SearchOptions options;
  std::vector<SolvedChart> charts;
  for (const auto& own : faces) charts.push_back(flat_chart(s, own, options.flatten));
  CHECK(mean_width(charts[0].flattening) < 0.003 && mean_width(charts[1].flattening) > 0.004);
  hang_small_charts(s, options, Context{}, charts);
  CHECK(charts.size() == 2);
}

void test_only_slivers_from_the_first_on_hang() {
  SearchOptions options;
  const Surface s = surface_of(corner(0.004));
  for (const auto& [first, left] : {std::pair(0, 1), std::pair(1, 1), std::pair(2, 2)}) {
    std::vector<SolvedChart> charts = unrolled_corner(s, options.flatten);
    hang_slivers(s, options, Context{}, first, charts);
    CHECK(static_cast<int>(charts.size()) == left);
  }
  const Surface large = surface_of(corner(0.5));
  std::vector<SolvedChart> charts = unrolled_corner(large, options.flatten);
  hang_slivers(large, options, Context{}, 0, charts);
  CHECK(charts.size() == 2);
}

void test_faces_that_rounding_may_lose_hang_nowhere() {
  const Surface s = surface_of(corner(0.004));
  SearchOptions options;
  // The upright face is 0.002 high and two others are 0.003: three of seven.
  for (const auto& [step, left] : {std::pair(1e-5, 1), std::pair(1e-3, 2)}) {
    options.rounding_step = step;
    std::vector<SolvedChart> charts = unrolled_corner(s, options.flatten);
    hang_small_charts(s, options, Context{}, charts);
    CHECK(static_cast<int>(charts.size()) == left);
  }
}

constexpr int tube_columns = 200;

/// A tube in charts of so many columns each, in turns.
std::vector<SolvedChart> tube_charts(const Surface& s, const std::vector<int>& columns,
                                     const FlattenOptions& options) {
  std::vector<int32_t> chart_of_column;
  for (size_t c = 0; c < columns.size(); ++c) {
    chart_of_column.insert(chart_of_column.end(), columns[c], static_cast<int32_t>(c));
  }
  CHECK(chart_of_column.size() == tube_columns);
  std::vector<std::vector<int32_t>> faces(columns.size());
  const Vec3 first = s.positions[s.faces[0][0]];
  for (int f = 0; f < s.face_count(); ++f) {
    Vec3 centre = Vec3::Zero();
    for (const int v : s.faces[f]) centre += s.positions[v] / 3.0;
    const double turns = (std::atan2(centre.y(), centre.x()) - std::atan2(first.y(), first.x())) /
                         (2.0 * std::numbers::pi);
    const int column = static_cast<int>(tube_columns * (turns + (turns < 0.0 ? 1.0 : 0.0)));
    faces[chart_of_column[column]].push_back(f);
  }
  std::vector<SolvedChart> charts;
  for (const std::vector<int32_t>& own : faces) {
    charts.push_back(flat_chart(s, own, options));
  }
  return charts;
}

void test_a_narrow_strip_hangs_on_by_one_of_two_runs() {
  // A tube that a strip closes: joined along both of its long sides it could not lie flat.
  const Surface s = surface_of(tube(tube_columns, 3));
  SearchOptions options;
  std::vector<SolvedChart> charts = tube_charts(s, {1, tube_columns - 1}, options.flatten);
  CHECK(charts.front().flattening.piece.surface.face_count() == 6);
  hang_small_charts(s, options, Context{}, charts);
  CHECK(charts.size() == 1);
  const Flattening& flat = charts.front().flattening;
  CHECK(flat.within && flat.piece.surface.face_count() == s.face_count());
  CHECK(flat.piece.loops.size() == 1);
  CHECK(flat.distortion.area < 1.01 && flat.distortion.angular > 0.99);
}

void test_charts_hang_the_same_on_any_number_of_threads() {
  const Surface s = surface_of(tube(tube_columns, 3));
  SearchOptions options;
  std::vector<std::vector<SolvedChart>> hung;
  for (const int threads : {1, 2, 4}) {
    hung.push_back(tube_charts(s, {1, 49, 2, 48, 1, 1, 98}, options.flatten));
    hang_small_charts(s, options, Context(threads), hung.back());
  }
  CHECK(hung.front().size() < 7);
  for (const std::vector<SolvedChart>& charts : hung) {
    CHECK(charts.size() == hung.front().size());
    for (size_t c = 0; c < charts.size(); ++c) {
      const Flattening &a = charts[c].flattening, &b = hung.front()[c].flattening;
      CHECK(a.piece.source_face == b.piece.source_face);
      CHECK(a.uv == b.uv);
    }
  }
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  test_a_fragment_grows_onto_its_neighbour();
  test_a_chart_hangs_on_by_a_side();
  test_small_charts_hang_and_large_ones_do_not();
  test_a_sliver_hangs_on_a_chart_of_less_area();
  test_only_slivers_from_the_first_on_hang();
  test_faces_that_rounding_may_lose_hang_nowhere();
  test_a_narrow_strip_hangs_on_by_one_of_two_runs();
  test_charts_hang_the_same_on_any_number_of_threads();
  return failures > 0;
}
