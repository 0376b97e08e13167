#pragma once

#include <vector>

#include "partuv/piece.hpp"

namespace partuv {

/// Where a piece is opened besides what its topology demands.
struct CutOptions {
  std::vector<int32_t> terminals;  ///< vertices that a cut must reach (tips, corners)
  bool join_tubes = true;          ///< join loops that end a tube; holes in a sheet stay
};

/// Sides to cut so that a connected piece gets a boundary and loses its handles, along short paths
/// that prefer creases and, more, concave ones. The piece stays connected. Handles: tree-cotree
/// decomposition (Eppstein 2003; Erickson and Whittlesey 2005); loops and terminals: the cut grows
/// to the nearest one until all are reached.
CutSides find_cuts(const Piece& piece, const CutOptions& options);

}  // namespace partuv
