#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "partuv/surface.hpp"

namespace partuv {

/// A triangle's rest shape laid flat: corners (0, 0), (length, 0), (x, y), y > 0.
struct RestTriangle {
  double length, x, y;
  double area() const { return 0.5 * length * y; }
};

/// A set of faces of a surface as a mesh of its own, ready to be flattened: the region of a chart,
/// opened along its cuts.
struct Piece {
  Surface surface;                     ///< the faces, locally numbered; cut sides are boundary
  std::vector<int32_t> source_face;    ///< local face -> face of the source
  std::vector<int32_t> source_vertex;  ///< local vertex -> vertex of the source
  std::vector<double> weight;          ///< how many faces of the caller's mesh a face stands for
  std::vector<Vec3> corner_angles;     ///< per face: the angles at its corners
  std::vector<std::vector<int32_t>> loops;  ///< boundary loops as local half-edges, longest first
  int euler = 0;                            ///< Euler characteristic V - E + F
  int component_count = 0;

  int genus() const { return (2 * component_count - euler - static_cast<int>(loops.size())) / 2; }
};

/// Cut sides of a surface, by half-edge; both sides of a cut edge are marked. Empty means no cuts.
using CutSides = std::vector<char>;

/// Take out the given faces (distinct) as a piece. `weight` is per face of the source, empty for 1.
Piece extract_piece(const Surface& source, const std::vector<int32_t>& faces,
                    const std::vector<double>& weight, const CutSides& cuts = {});

/// The same piece opened along cut sides, given by local half-edge.
Piece open_piece(const Piece& piece, const CutSides& cuts);

/// Length in space of a boundary loop, given as half-edges.
double loop_length(const Surface& surface, const std::vector<int32_t>& loop);

/// Rest shapes of a piece's faces. Needles and degenerate faces are thickened to at least
/// `least_height` times their longest side, so that every shape can be inverted.
std::vector<RestTriangle> rest_shapes(const Surface& surface, double least_height = 1e-6);

/// Sum of the corner angles at each vertex.
std::vector<double> angle_sums(const Piece& piece);

/// Angle defect of each vertex: 2 pi minus its corner angles, 0 on the boundary.
std::vector<double> angle_defects(const Piece& piece);

/// True for each vertex on the boundary.
std::vector<char> boundary_vertices(const Surface& surface);

}  // namespace partuv
