// Cuts open every surface to a disk, or to a sheet that keeps its holes.

#include "check.hpp"
#include "partuv/cut.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

Piece piece_of(const Mesh& mesh) { return whole_piece(surface_of(mesh)); }

bool is_disk(const Piece& piece) {
  return piece.component_count == 1 && piece.loops.size() == 1 && piece.euler == 1 &&
         piece.genus() == 0;
}

void test_topology_is_read() {
  CHECK(piece_of(sphere(2)).genus() == 0 && piece_of(sphere(2)).loops.empty());
  CHECK(piece_of(torus(9, 6)).genus() == 1);
  CHECK(piece_of(pierced_plate(3)).genus() == 3);
  CHECK(piece_of(tube(8, 2)).loops.size() == 2);
  CHECK(is_disk(piece_of(sheet(3, 4))));
}

void test_all_open_to_disks() {
  std::mt19937 random(5);
  for (int round = 0; round < 4; ++round) {
    for (Mesh mesh : {sphere(1), sphere(3), torus(9, 6), torus(24, 12), pierced_plate(1),
                      pierced_plate(2), pierced_plate(4), tube(3, 1), tube(12, 6)}) {
      shake(mesh, 0.02 * round, random);
      const Piece piece = piece_of(mesh);
      const CutSides cuts = find_cuts(piece, CutOptions{});
      for (size_t h = 0; h < cuts.size(); ++h) {
        const int other = piece.surface.opposite[h / 3][h % 3];
        CHECK(!cuts[h] || (other >= 0 && cuts[other]));
      }
      const Piece opened = open_piece(piece, cuts);
      CHECK(is_disk(opened));
      CHECK(opened.surface.face_count() == piece.surface.face_count());
    }
  }
}

void test_disks_and_holes_stay() {
  for (const Mesh& mesh : {sheet(1, 1), sheet(4, 5), sheet_with_hole()}) {
    const Piece piece = piece_of(mesh);
    for (const char cut : find_cuts(piece, CutOptions{})) CHECK(!cut);
  }
}

void test_terminals_are_reached() {
  std::mt19937 random(11);
  for (const Mesh& mesh : {sphere(2), torus(12, 8), tube(12, 4), sheet(8, 8), pierced_plate(2)}) {
    const Piece piece = piece_of(mesh);
    std::uniform_int_distribution<int32_t> any(0, piece.surface.vertex_count() - 1);
    for (int round = 0; round < 5; ++round) {
      CutOptions options;
      for (int i = 0; i <= round; ++i) options.terminals.push_back(any(random));
      const Piece opened = open_piece(piece, find_cuts(piece, options));
      // A closed sphere with one terminal twice still opens.
      CHECK(opened.component_count == 1 && opened.genus() == 0 && opened.loops.size() == 1);
      const std::vector<char> boundary = boundary_vertices(opened.surface);
      for (const int terminal : options.terminals) {
        for (size_t v = 0; v < boundary.size(); ++v) {
          if (opened.source_vertex[v] == terminal) CHECK(boundary[v]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  test_topology_is_read();
  test_all_open_to_disks();
  test_disks_and_holes_stay();
  test_terminals_are_reached();
  return failures;
}
