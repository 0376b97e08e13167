#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/error.hpp"
#include "partuv/surface.hpp"

namespace partuv {

/// The caller's mesh as a surface that can be flattened, and the way back.
///
/// Exactly coincident positions are welded; corners are then joined into the surface's vertices
/// only across sides that meet (`link_opposites`). Bow-ties, winding conflicts and what meets
/// nothing at edges of many faces thereby become boundary. Faces that repeat a welded vertex have
/// no sides to join and stay outside of the surface (`collapsed`); no other face is left out and no
/// vertex moves.
struct Topology {
  Surface surface;
  std::vector<int32_t> source_face;    ///< surface face -> face of the caller's mesh
  std::vector<int8_t> first_corner;    ///< surface face -> corner of that face that is its corner 0
  std::vector<int32_t> source_vertex;  ///< surface vertex -> welded vertex number
  std::vector<int32_t> collapsed;      ///< faces of the caller's mesh outside of the surface
  std::vector<Triangle> welded;        ///< F x 3 welded vertex numbers of the caller's faces
  double area = 0.0;                   ///< total area of the surface
  /// Positions of the surface's vertices before they were rounded; none where they never were.
  std::vector<Vec3> unrounded;
};

/// How the faces and vertices of a surface are numbered.
enum class Numbering {
  of_mesh,  ///< as in the caller's mesh
  /// In an order that does not depend on how the caller numbered them, nor on the mesh's place,
  /// size or rotation: every decision that goes by numbers then comes out alike. Components come by
  /// area. Within one, faces come breadth first from the corner that lies farthest out; only what
  /// is alike by rotation is told apart by the caller's numbers. Positions then are in a frame of
  /// the mesh's own, and rounded to 2^-30 of the root of the area, or to a hundredth of the height
  /// of the lowest face around them that has one.
  canonical,
};

/// Build the topology of a mesh. Positions are moved to the origin and scaled to unit total area,
/// so that nothing later depends on the size or the place of the mesh. A mesh of which every face
/// is below `least_area` is refused.
Result<Topology> build_topology(const Mesh& mesh, const Context& context = Context(),
                                Numbering numbering = Numbering::of_mesh);

/// Area below which a face has no meaningful shape in single precision: 1e-14 of the squared
/// diagonal of the bounding box.
double least_area(const Surface& surface);

}  // namespace partuv
