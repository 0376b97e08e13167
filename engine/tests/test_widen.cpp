// Charts that are too thin and take faces over from neighbouring ones.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "charts.hpp"
#include "check.hpp"
#include "partuv/flatten.hpp"
#include "partuv/solve.hpp"
#include "segment/graft.hpp"
#include "segment/grafter.hpp"
#include "segment/thin.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

void test_a_sliver_takes_faces_over() {
  SearchOptions options;
  for (const auto& [cells, wide_enough] : {std::pair(10, true), std::pair(1, false)}) {
    const Surface s = surface_of(sheet(cells, cells));
    std::vector<int32_t> host;
    for (int f = 1; f < s.face_count(); ++f) host.push_back(f);
    std::vector<SolvedChart> charts;
    for (const std::vector<int32_t>& faces : {std::vector<int32_t>{0}, host}) {
      Piece piece = extract_piece(s, faces, {});
      std::vector<Vec2> uv = plan(piece);
      charts.push_back({judged(std::move(piece), std::move(uv), options.flatten), 0});
    }
    const Context context;
    Grafter grafter(s, options, context, charts);
    const double width = 1.5 * narrow_width(charts.front().flattening);
    CHECK(grafter.widen(0, width) == wide_enough);  // one of two faces is too much of a host
    CHECK((narrow_width(charts.front().flattening) >= width) == wide_enough);
    std::vector<int> seen(s.faces.size(), 0);
    for (const SolvedChart& chart : charts) {
      CHECK(chart.flattening.within && chart.flattening.piece.component_count == 1);
      for (const int f : chart.flattening.piece.source_face) ++seen[f];
    }
    for (const int count : seen) CHECK(count == 1);
  }
}

/// A disc of eight faces, slit along a radius, one bank raised by `height`; a face that stands
/// upright between the banks closes it.
Mesh raised_slit(double height) {
  constexpr int sectors = 8;
  constexpr double gap_rad = 0.001;
  Mesh mesh;
  mesh.positions = {Vec3(0, 0, 0)};
  for (int i = 0; i <= sectors; ++i) {
    const double angle = i * (2.0 * std::numbers::pi - gap_rad) / sectors;
    mesh.positions.push_back(Vec3(std::cos(angle), std::sin(angle), i == sectors ? height : 0.0));
  }
  for (int i = 1; i <= sectors; ++i) mesh.faces.push_back({0, i, i + 1});
  mesh.faces.push_back({0, sectors + 1, 1});
  return mesh;
}

void test_a_sliver_that_hangs_nowhere_takes_faces_over() {
  const Surface s = surface_of(raised_slit(0.008));
  SearchOptions options;
  // The disc would have to give way for the sliver to lie beside either bank.
  options.flatten.max_area_distortion = 1.00001;
  options.flatten.min_angular = 0.99999;
  std::vector<int32_t> host, upright;
  for (int f = 0; f < s.face_count(); ++f) {
    (std::abs(face_cross(s, f).normalized().z()) < 0.5 ? upright : host).push_back(f);
  }
  CHECK(upright.size() == 1);
  std::vector<SolvedChart> charts;
  for (const auto* faces : {&host, &upright}) {
    Piece piece = extract_piece(s, *faces, {});
    ConformalScale scale = predict_scale(piece, Context{});
    charts.push_back(
        {flatten({std::move(piece), std::move(scale)}, options.flatten, Context{}), 0});
    CHECK(charts.back().flattening.within);
  }
  CHECK(mean_width(charts.back().flattening) < 0.003);
  hang_small_charts(s, options, Context{}, charts);
  CHECK(charts.size() == 2);
  for (const SolvedChart& chart : charts) {
    CHECK(chart.flattening.within && mean_width(chart.flattening) > 0.1);
  }
}

void test_a_sliver_takes_what_it_cuts_off_its_host() {
  // A long strip two faces wide: to be nearly as wide, the sliver has to reach across it.
  Mesh mesh = sheet(20, 2);
  for (Vec3& p : mesh.positions) p = Vec3(10.0 * p.x(), 0.1 * p.y(), 0.0);
  const Surface s = surface_of(mesh);
  const auto middle = [&](int f) {
    return (s.positions[s.faces[f][0]] + s.positions[s.faces[f][1]] + s.positions[s.faces[f][2]])
        .norm();
  };
  int centre = 0;
  for (int f = 1; f < s.face_count(); ++f) centre = middle(f) < middle(centre) ? f : centre;
  std::vector<int32_t> host;
  for (int f = 0; f < s.face_count(); ++f) {
    if (f != centre) host.push_back(f);
  }
  SearchOptions options;
  std::vector<SolvedChart> charts{flat_chart(s, {centre}, options.flatten),
                                  flat_chart(s, host, options.flatten)};
  const Context context;
  Grafter grafter(s, options, context, charts);
  CHECK(grafter.widen(0, 0.08));
  int faces = 0;
  for (const SolvedChart& chart : charts) {
    const Flattening& flat = chart.flattening;
    CHECK(flat.within && flat.piece.component_count == 1 && narrow_width(flat) > 0.08);
    faces += flat.piece.surface.face_count();
  }
  CHECK(faces == s.face_count());
}

/// A square sheet of unit area; the point in its middle is raised, and the faces around that are a
/// chart, the first of the two.
struct Bump {
  Surface surface;
  std::vector<SolvedChart> charts;

  explicit Bump(int cells, double height, const FlattenOptions& options) {
    Mesh mesh = sheet(cells, cells);
    mesh.positions[cells / 2 * (cells + 1) + cells / 2].z() = height;
    surface = surface_of(mesh);
    std::vector<int32_t> raised, rest;
    for (int f = 0; f < surface.face_count(); ++f) {
      double low = 1.0, high = -1.0;
      for (const int v : surface.faces[f]) {
        low = std::min(low, surface.positions[v].z());
        high = std::max(high, surface.positions[v].z());
      }
      (high - low > 0.5 * height ? raised : rest).push_back(f);
    }
    CHECK(raised.size() == 6);
    Piece piece = extract_piece(surface, rest, {});
    std::vector<Vec2> uv = plan(piece);
    charts = {flat_chart(surface, raised, options),
              {judged(std::move(piece), std::move(uv), options), 0}};
    CHECK(charts.back().flattening.within);
  }
};

void test_a_sliver_is_widened_along_all_that_it_shares() {
  // Hung on by one side, the bump would lie on what is taken all around it.
  SearchOptions options;
  options.flatten.min_angular = 0.6;  // it is steep
  Bump bump(20, 0.04, options.flatten);
  const Context context;
  Grafter grafter(bump.surface, options, context, bump.charts);
  CHECK(grafter.widen(0, 0.15));
  for (const SolvedChart& chart : bump.charts) {
    CHECK(chart.flattening.within && narrow_width(chart.flattening) >= 0.15);
  }
}

void test_small_faces_are_taken_by_the_hundred() {
  SearchOptions options;
  Bump bump(60, 0.004, options.flatten);
  const Context context;
  Grafter grafter(bump.surface, options, context, bump.charts);
  CHECK(grafter.widen(0, 0.08));
  CHECK(bump.charts.front().flattening.piece.surface.face_count() > 100);
}

void test_widths_of_a_strip_and_of_a_square() {
  const Surface square = surface_of(sheet(10, 10));
  Mesh mesh = sheet(40, 5);
  for (Vec3& p : mesh.positions) p = Vec3(4.0 * p.x(), 0.25 * p.y(), 0.0);
  const Surface strip = surface_of(mesh);
  for (const auto& [s, narrow, mean] :
       {std::tuple(&square, 1.0, 0.5), std::tuple(&strip, 0.25, 2.0 / 8.5)}) {
    Piece piece = whole_piece(*s);
    std::vector<Vec2> uv = plan(piece);
    const Flattening flat = judged(std::move(piece), std::move(uv), {});
    CHECK(std::abs(narrow_width(flat) - narrow) < 1e-6);
    CHECK(std::abs(mean_width(flat) - mean) < 1e-6);
  }
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  test_a_sliver_takes_faces_over();
  test_a_sliver_that_hangs_nowhere_takes_faces_over();
  test_a_sliver_takes_what_it_cuts_off_its_host();
  test_a_sliver_is_widened_along_all_that_it_shares();
  test_small_faces_are_taken_by_the_hundred();
  test_widths_of_a_strip_and_of_a_square();
  return failures > 0;
}
