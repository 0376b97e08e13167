// What puts a flattening right after it has gone wrong: untangling, cutting apart, grafting.
#include <cmath>
#include <numbers>

#include "check.hpp"
#include "flatten/system.hpp"
#include "partuv/flatten.hpp"
#include "segment/graft.hpp"
#include "segment/grafter.hpp"
#include "segment/separate.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

/// A flat sheet as it lies, seen from the side from which its faces turn counter-clockwise.
std::vector<Vec2> plan(const Piece& piece) {
  const double side = face_cross(piece.surface, 0).z() > 0.0 ? 1.0 : -1.0;
  std::vector<Vec2> uv;
  for (const Vec3& p : piece.surface.positions) uv.emplace_back(p.x(), side * p.y());
  return uv;
}

void test_flipped_faces_turn_over() {
  const Surface s = surface_of(sheet(8, 8));
  const Piece piece = whole_piece(s);
  const std::vector<RestTriangle> rest = rest_shapes(s);
  std::mt19937 random(3);
  std::normal_distribution<double> away(0.0, 0.06);
  for (int round = 0; round < 5; ++round) {
    std::vector<Vec2> uv = plan(piece);
    for (Vec2& p : uv) p += Vec2(away(random), away(random));
    CHECK(measure(piece, uv, 0.0).flipped > 0);
    MeshSystem<2> system(piece.surface.faces, piece.surface.vertex_count());
    PolishOptions options;
    options.steps = 60;
    CHECK(untangle(piece, rest, options, Context{}, system, uv));
    CHECK(measure(piece, uv, 0.0).flipped == 0);
  }
}

void test_fixed_vertices_stay() {
  const Surface s = surface_of(sheet(8, 8));
  const Piece piece = whole_piece(s);
  std::vector<Vec2> uv = plan(piece);
  for (Vec2& p : uv) p *= 1.0 + 0.3 * p.x();
  const std::vector<Vec2> before = uv;
  PolishOptions options;
  options.fixed.assign(uv.size(), 0);
  for (size_t v = 0; v < uv.size(); v += 7) options.fixed[v] = 1;
  MeshSystem<2> system(piece.surface.faces, piece.surface.vertex_count());
  polish(piece, rest_shapes(s), options, [] { return false; }, Context{}, system, uv);
  CHECK(uv[1] != before[1]);
  for (size_t v = 0; v < uv.size(); v += 7) CHECK(uv[v] == before[v]);
}

/// A long sheet wound up in the plane, so that its end lies on its beginning.
Flattening wound_up(const Surface& s, const FlattenOptions& options) {
  Piece piece = whole_piece(s);
  std::vector<Vec2> uv = plan(piece);
  for (Vec2& p : uv) {
    const double angle = 2.2 * std::numbers::pi * p.x(), radius = 0.5 - 0.1 * p.y();
    p = radius * Vec2(std::cos(angle), std::sin(angle));
  }
  return judged(std::move(piece), std::move(uv), options);
}

/// A flat ring that goes around `turns` times and climbs a little: its plan lies on itself.
Mesh ramp(double turns, int rows = 6) {
  Mesh mesh = sheet(120, rows);
  for (Vec3& p : mesh.positions) {
    const double angle = 2.0 * std::numbers::pi * turns * p.x(), radius = 1.0 + 0.4 * p.y();
    p = Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.05 * p.x());
  }
  return mesh;
}

/// Whether the plan of a mesh, mirrored to run counter-clockwise, lies on itself hopelessly.
bool has_hopeless_plan(const Mesh& mesh) {
  const Piece piece = whole_piece(surface_of(mesh));
  std::vector<Vec2> uv;
  for (const Vec3& p : piece.surface.positions) uv.emplace_back(p.y(), p.x());
  return overlaps_widely(piece, uv);
}

void test_wide_and_deep_overlaps_are_hopeless() {
  const auto hopeless = [](double turns, int rows) { return has_hopeless_plan(ramp(turns, rows)); };
  CHECK(!hopeless(0.9, 6) && !hopeless(1.005, 6) && !hopeless(1.005, 20));
  CHECK(hopeless(2.0, 6));    // nearly every vertex of the boundary lies on another part
  CHECK(hopeless(1.05, 20));  // few of them do, but far from the border
}

/// Faces around one vertex of the boundary, like steps of a winding stair that becomes narrower.
Mesh stair(double turns, int steps) {
  Mesh mesh;
  mesh.positions.push_back(Vec3::Zero());
  for (int i = 0; i <= steps; ++i) {
    const double angle = 2.0 * std::numbers::pi * turns * i / steps, radius = std::pow(0.95, i);
    mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.01 * i);
    if (i > 0) mesh.faces.push_back({0, i + 1, i});
  }
  return mesh;
}

void test_overlaps_around_a_vertex_are_hopeless() {
  // Few vertices lie on another part, none of them deep.
  CHECK(!has_hopeless_plan(stair(0.9, 6)) && !has_hopeless_plan(stair(1.2, 8)));
  CHECK(has_hopeless_plan(stair(1.5, 10)));
}

void test_overlaps_are_spread_apart() {
  for (const double turns : {1.005, 2.0}) {
    const Surface s = surface_of(ramp(turns));
    const Piece piece = whole_piece(s);
    const std::vector<RestTriangle> rest = rest_shapes(s);
    MeshSystem<2> system(piece.surface.faces, piece.surface.vertex_count());
    std::vector<Vec2> uv = conformal_layout(piece, rest, Context{}, system);
    CHECK(measure(piece, uv, 0.0).flipped == 0);
    CHECK(!boundary_is_simple(piece, uv) && !boundary_meetings(piece, uv, 1).empty());
    const bool apart =
        spread_apart(piece, rest, PolishOptions{}, 20, [] { return false; }, Context{}, system, uv);
    CHECK(apart == (turns < 2.0));  // what covers itself throughout is left for a cut
    CHECK(apart == boundary_is_simple(piece, uv) &&
          apart == boundary_meetings(piece, uv, 1).empty());
    CHECK(measure(piece, uv, 0.0).flipped == 0 && measure(piece, uv, 0.0).area < 1.3);
  }
}

double outline_length(const Piece& piece) {
  return loop_length(piece.surface, piece.loops.front());
}

void test_overlaps_are_cut_apart(int rows, int columns) {
  Mesh mesh = sheet(rows, columns);
  for (Vec3& p : mesh.positions) p.y() *= 0.5 + std::abs(p.x() - 0.5);  // has a waist
  const Surface s = surface_of(mesh);
  FlattenOptions options;
  options.max_area_distortion = 10.0;  // the winding stretches: only the overlap matters here
  options.min_angular = 0.0;
  const Flattening flat = wound_up(s, options);
  CHECK(!flat.valid && flat.distortion.flipped == 0);
  const auto [parts, left_over] = cut_apart(flat, options, Context{});
  CHECK(!parts.empty());
  std::vector<int32_t> seen(s.faces.size(), 0);
  double outline = 0.0;
  for (const Flattening& part : parts) {
    CHECK(part.within);
    for (int f : part.piece.source_face) ++seen[f];
    outline += outline_length(part.piece);
  }
  const double waist = 0.5 / std::sqrt(0.75);  // the area of the sheet is made 1
  CHECK(outline < outline_length(whole_piece(s)) + 2.0 * 1.1 * waist);
  for (const auto& faces : left_over) {
    for (int f : faces) ++seen[f];
  }
  for (int count : seen) CHECK(count == 1);
}

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

void test_a_sliver_hangs_on_by_a_side() {
  SearchOptions options;
  options.flatten.max_area_distortion = 1.0001;  // a sliver that hung on by both would not hold it
  options.flatten.min_angular = 0.9999;
  for (const auto& [size, left] : {std::pair(0.004, 1), std::pair(0.5, 2)}) {
    const Surface s = surface_of(corner(size));
    std::vector<SolvedChart> charts = unrolled_corner(s, options.flatten);
    CHECK(charts.front().flattening.distortion.area < 1.0001);
    hang_narrow_charts(s, options, Context{}, charts);
    CHECK(static_cast<int>(charts.size()) == left);  // a wide chart is no sliver
    for (const SolvedChart& chart : charts) {
      CHECK(chart.flattening.within && chart.flattening.distortion.area < 1.0001);
    }
    if (left == 1) CHECK(charts.front().flattening.piece.surface.face_count() == s.face_count());
  }
}

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
    const double width = 1.5 * mean_width(charts.front().flattening);
    CHECK(grafter.widen(0, width) == wide_enough);  // one of two faces is too much of a host
    CHECK((mean_width(charts.front().flattening) >= width) == wide_enough);
    std::vector<int> seen(s.faces.size(), 0);
    for (const SolvedChart& chart : charts) {
      CHECK(chart.flattening.within && chart.flattening.piece.component_count == 1);
      for (const int f : chart.flattening.piece.source_face) ++seen[f];
    }
    for (const int count : seen) CHECK(count == 1);
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
    Piece piece = extract_piece(s, own, {});
    ConformalScale scale = predict_scale(piece, Context{});
    charts.push_back({flatten({std::move(piece), std::move(scale)}, options, Context{}), 0});
    CHECK(charts.back().flattening.within);
  }
  return charts;
}

void test_a_narrow_strip_hangs_on_by_one_of_two_runs() {
  // A tube that a strip closes: joined along both of its long sides it could not lie flat.
  const Surface s = surface_of(tube(tube_columns, 3));
  SearchOptions options;
  std::vector<SolvedChart> charts = tube_charts(s, {1, tube_columns - 1}, options.flatten);
  CHECK(charts.front().flattening.piece.surface.face_count() == 6);
  hang_narrow_charts(s, options, Context{}, charts);
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
    hang_narrow_charts(s, options, Context(threads), hung.back());
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

void test_a_chart_is_tightened_by_what_rounding_adds() {
  const Surface s = surface_of(sphere(4));
  std::vector<int32_t> cap;
  for (int f = 0; f < s.face_count(); ++f) {
    if (face_cross(s, f).normalized().z() > 0.3) cap.push_back(f);
  }
  SearchOptions options;
  Piece piece = extract_piece(s, cap, {});
  ConformalScale scale = predict_scale(piece, Context{});
  const Flattening flat = flatten({std::move(piece), std::move(scale)}, options.flatten, Context{});
  CHECK(flat.within && flat.distortion.area > 1.03);
  // As if the chart had only just kept the bound, and rounding taken it beyond it by that much.
  options.flatten.max_area_distortion = flat.distortion.area;
  options.flatten.min_angular = 0.8;
  for (const auto& [added, possible] : {std::pair(0.01, true), std::pair(0.5, false)}) {
    std::vector<SolvedChart> charts{{flat, 0}};
    const std::vector<ChartExcess> left =
        tighten_charts({{0, flat.distortion.area + added, {}}}, options, Context{}, charts);
    const Flattening& tight = charts.front().flattening;
    CHECK(left.empty() == possible);
    CHECK(tight.valid && tight.piece.source_face == flat.piece.source_face);
    if (possible) {
      CHECK(tight.distortion.area <= flat.distortion.area - added);
    } else {
      CHECK(tight.uv == flat.uv && left.size() == 1 && left.front().chart == 0);
    }
  }
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  test_flipped_faces_turn_over();
  test_fixed_vertices_stay();
  test_wide_and_deep_overlaps_are_hopeless();
  test_overlaps_around_a_vertex_are_hopeless();
  test_overlaps_are_spread_apart();
  test_overlaps_are_cut_apart(60, 2);
  test_overlaps_are_cut_apart(170, 160);  // enough faces to be cut in clumps first
  test_a_fragment_grows_onto_its_neighbour();
  test_a_sliver_hangs_on_by_a_side();
  test_a_sliver_takes_faces_over();
  test_a_narrow_strip_hangs_on_by_one_of_two_runs();
  test_charts_hang_the_same_on_any_number_of_threads();
  test_a_chart_is_tightened_by_what_rounding_adds();
  return failures > 0;
}
