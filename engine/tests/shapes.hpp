#pragma once

#include <cstdint>
#include <random>

#include "partuv/piece.hpp"
#include "partuv/surface.hpp"
#include "partuv/types.hpp"

namespace partuv::test {

/// rows x columns cells of two triangles in the unit square of the z = 0 plane.
Mesh sheet(int rows, int columns);
/// A sheet of 5 x 5 cells without the middle one.
Mesh sheet_with_hole();
/// A cylinder without its ends.
Mesh tube(int around, int along);
Mesh torus(int around, int along);
/// The boundary of unit cells in a plate of (2 holes + 1) x 3, pierced: a surface of that genus.
Mesh pierced_plate(int holes);
/// The unit sphere from an octahedron whose faces are split in four `levels` times.
Mesh sphere(int levels);
/// Triangles between random points.
Mesh soup(int points, int faces, std::mt19937& random);
/// Move every vertex by a normal deviate.
void shake(Mesh& mesh, double amount, std::mt19937& random);
/// The surface of a mesh that is known to be fine.
Surface surface_of(const Mesh& mesh);
/// All of a surface as one piece.
Piece whole_piece(const Surface& surface);
/// A flat sheet as it lies, seen from the side from which its faces turn counter-clockwise.
std::vector<Vec2> plan(const Piece& piece);

}  // namespace partuv::test
