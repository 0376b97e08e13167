#pragma once

#include <span>

#include "partuv/tree.hpp"

namespace partuv {

struct NbmOptions {
  double convex_weight = 0.15;  ///< eta: how much a convex crease counts against a concave one (1)
  double contrast = 2.0;        ///< w: how steeply a crease lowers the conductance of an edge
  double least_similarity = 0.02;  ///< conductance per length of the sharpest crease
};

/// Normalised-boundary merging: the adjacent pair of regions A, B whose common boundary is least
/// cut-like for its size, i.e. with the largest C(A, B) (1 / area(A) + 1 / area(B)), is merged
/// first; C sums edge length times similarity, which falls with the crease, most where the surface
/// is concave. What remains at the top of the tree are short, concave cuts.
///
/// Component first: a connected component is one subtree; their roots are joined by Ward's
/// criterion on area and mean position. Equal scores (in single precision, so that rounding does
/// not decide) go to the smaller nodes. A closed component that encloses negative volume is taken
/// as inside out.
///
/// `face_areas` replaces the areas of the surface, for a stand-in of a finer one. Past the deadline
/// what is left is joined in face order: the tree is complete and component first, though worse. A
/// cancelled call returns some tree.
/// O(F log F) time, about 150 bytes per face.
PartTree build_nbm_tree(const Surface& surface, const NbmOptions& options, const Context& context,
                        std::span<const double> face_areas = {});

}  // namespace partuv
