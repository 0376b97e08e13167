// Proof of injectivity from the boundary.
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
  for (const double off : {-1e-13, 0.0, 1e-13}) {  // rounding does not say whether they overlap
    const std::vector<Vec2> ring = arc(piece, 2.0 * pi + off, 2.0);
    CHECK(!boundary_is_simple(piece, ring) && !overlaps_widely(piece, ring));
    CHECK(boundary_is_simple(piece, inset_boundary(piece, ring)));
  }
  const std::vector<Vec2> lapped = arc(piece, 2.1 * pi, 2.0);
  CHECK(!boundary_is_simple(piece, inset_boundary(piece, lapped)));
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
  test_folding_back();
  test_holes();
  return failures;
}
