// Proof of injectivity from the boundary.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "check.hpp"
#include "partuv/flatten.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

Piece piece_of(const Mesh& mesh) { return whole_piece(surface_of(mesh)); }

/// Lay a sheet out by a map of its own coordinates, in units of its side from -0.5 to 0.5.
template <typename Map>
std::vector<Vec2> laid(const Piece& piece, const Map& map) {
  std::vector<Vec2> uv;
  for (const Vec3& p : piece.surface.positions) uv.push_back(map(p.x(), p.y()));
  return uv;
}

/// A strip bent to an arc; the sheet is 1 wide and long, the arc `turn` rad.
std::vector<Vec2> arc(const Piece& piece, double turn, double inner_radius, double climb = 0.0) {
  return laid(piece, [&](double x, double y) {
    const double angle = turn * (x + 0.5), radius = inner_radius + 0.5 + y + climb * (x + 0.5);
    return Vec2(radius * std::sin(angle), radius * std::cos(angle));
  });
}

void test_sheets() {
  const Piece piece = piece_of(sheet(40, 4));
  CHECK(boundary_is_simple(piece, laid(piece, [](double x, double y) { return Vec2(x, y); })));
  CHECK(!boundary_is_simple(piece, laid(piece, [](double x, double y) { return Vec2(y, x); })));
  CHECK(!boundary_is_simple(piece, laid(piece, [](double, double) { return Vec2(0.0, 0.0); })));
  CHECK(!boundary_is_simple(
      piece, laid(piece, [](double x, double) { return Vec2(x > 0.4 ? std::nan("") : x, 0.0); })));
  constexpr double pi = std::numbers::pi;
  CHECK(boundary_is_simple(piece, arc(piece, 1.9 * pi, 2.0)));
  CHECK(!boundary_is_simple(piece, arc(piece, 2.1 * pi, 2.0)));       // bites its tail
  CHECK(boundary_is_simple(piece, arc(piece, 5.0 * pi, 2.0, 4.0)));   // a spiral has room
  CHECK(!boundary_is_simple(piece, arc(piece, 5.0 * pi, 2.0, 2.0)));  // but not here
}

void test_ends_that_touch() {
  const Piece piece = piece_of(sheet(40, 4));
  constexpr double pi = std::numbers::pi;
  for (const double off : {-1e-9, 0.0, 1e-9}) {  // rounding does not say whether they overlap
    const std::vector<Vec2> ring = arc(piece, 2.0 * pi + off, 2.0);
    CHECK(!boundary_is_simple(piece, ring) && !overlaps_widely(piece, ring));
    CHECK(boundary_is_simple(piece, inset_boundary(piece, ring)));
  }
  const std::vector<Vec2> lapped = arc(piece, 2.1 * pi, 2.0);
  CHECK(!boundary_is_simple(piece, inset_boundary(piece, lapped)));
}

void test_a_slit_opens_the_same_way_however_it_lies() {
  const Piece sheet_piece = piece_of(sheet(8, 8));
  const Surface& s = sheet_piece.surface;
  CutSides cuts(3 * s.faces.size(), 0);
  for (size_t h = 0; h < cuts.size(); ++h) {  // along y = 0 as far as the middle
    const Vec3 &from = s.positions[s.faces[h / 3][h % 3]],
               &to = s.positions[s.faces[h / 3][(h % 3 + 1) % 3]];
    cuts[h] = std::abs(from.y()) + std::abs(to.y()) < 1e-9 && from.x() + to.x() < 0.0;
  }
  const Piece piece = open_piece(sheet_piece, cuts);
  CHECK(piece.surface.vertex_count() == s.vertex_count() + 4);
  const auto turned = [&](double angle) {
    const Eigen::Rotation2Dd rotation(angle);
    double rounding = 0.0;  // of a solver: the two sides of the slit do not lie quite the same
    return laid(piece, [&](double x, double y) {
      rounding = 1e-15 - rounding;
      return Vec2(rotation * Vec2(x, y) + Vec2(rounding, 0.0));
    });
  };
  const std::vector<Vec2> plain = inset_boundary(piece, turned(0.0));
  for (const double angle : {0.1, 1.0, 2.0, 3.0}) {
    CHECK(!boundary_is_simple(piece, turned(angle)));
    const std::vector<Vec2> inset = inset_boundary(piece, turned(angle));
    CHECK(boundary_is_simple(piece, inset));
    double farthest = 0.0;
    for (size_t v = 0; v < plain.size(); ++v) {
      const Vec2 expected = Eigen::Rotation2Dd(angle) * plain[v];
      farthest = std::max(farthest, (expected - inset[v]).norm());
    }
    CHECK(farthest < 1e-12);
  }
}

void test_folding_back() {
  const Piece piece = piece_of(sheet(1, 1));
  std::vector<Vec2> uv = laid(piece, [](double x, double y) { return Vec2(x, y); });
  CHECK(boundary_is_simple(piece, uv));
  // The second corner moves onto the side between the first and the third: the loop runs back.
  const Triangle t = piece.surface.faces[0];
  uv[t[1]] = 0.5 * (uv[t[0]] + uv[t[2]]);
  CHECK(boundary_is_simple(piece, uv));
  uv[t[1]] = uv[piece.surface.faces[1][2]];
  CHECK(!boundary_is_simple(piece, uv));
}

void test_holes() {
  const Piece piece = piece_of(sheet_with_hole());
  CHECK(piece.loops.size() == 2);
  const std::vector<Vec2> flat = laid(piece, [](double x, double y) { return Vec2(x, y); });
  CHECK(boundary_is_simple(piece, flat));
  // The mirrored inversion at the centre swaps outline and hole, and covers each point once.
  CHECK(boundary_is_simple(piece, laid(piece, [](double x, double y) {
                             const double squared = x * x + y * y;
                             return Vec2(x / squared, -y / squared);
                           })));
  // The complex square goes round twice.
  CHECK(!boundary_is_simple(
      piece, laid(piece, [](double x, double y) { return Vec2(x * x - y * y, 2.0 * x * y); })));
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  test_sheets();
  test_ends_that_touch();
  test_a_slit_opens_the_same_way_however_it_lies();
  test_folding_back();
  test_holes();
  return failures;
}
