#pragma once

#include <cstdint>
#include <vector>

#include "flatten/supernodes.hpp"

namespace partuv {

/// The pattern of a symmetric matrix: neighbours of each vertex, itself included, ascending.
struct VertexGraph {
  std::vector<int32_t> first;  ///< V + 1
  std::vector<int32_t> other;

  int vertex_count() const { return static_cast<int>(first.size()) - 1; }
};

LowerPattern lower_pattern(const VertexGraph& graph, const std::vector<int32_t>& order);

/// An order of elimination with little fill: the vertex at each place. It is a postorder of its
/// elimination tree.
std::vector<int32_t> elimination_order(const VertexGraph& graph);

/// The same order with each column after all columns below it in the elimination tree, and right
/// after the last of them. It fills in the same entries.
std::vector<int32_t> postordered(const VertexGraph& graph, const std::vector<int32_t>& order);

}  // namespace partuv
