#pragma once

#include <cstdint>
#include <vector>

#include "flatten/supernodes.hpp"

namespace partuv {

/// The pattern of a symmetric matrix: neighbours of each vertex, itself included, in any order.
struct VertexGraph {
  std::vector<int32_t> first;  ///< V + 1
  std::vector<int32_t> other;

  int vertex_count() const { return static_cast<int>(first.size()) - 1; }
};

/// An order of elimination with little fill, and the pattern in that order.
struct Elimination {
  std::vector<int32_t> rank;  ///< place of each vertex in a postorder of the elimination tree
  LowerPattern pattern;
};

Elimination plan_elimination(const VertexGraph& graph);

}  // namespace partuv
