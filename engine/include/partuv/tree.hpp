#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/error.hpp"
#include "partuv/surface.hpp"

namespace partuv {

/// Binary merge tree over F faces in flat arrays. Nodes 0..F-1 are the faces, F..2F-2 the merges in
/// the order in which they were made (a node's children have smaller numbers), the root is the
/// last. Faces are permuted so that every node is one contiguous interval of `order`: the faces of
/// a node cost nothing to list.
struct PartTree {
  int face_count = 0;
  std::vector<int32_t> left, right;  ///< children of node F + i, F - 1 entries each
  std::vector<int32_t> order;        ///< the F faces, in leaf order
  std::vector<int32_t> begin, end;   ///< interval of each node in `order`, 2F - 1 entries each

  int root() const { return 2 * face_count - 2; }
  bool is_leaf(int node) const { return node < face_count; }
  int size(int node) const { return end[node] - begin[node]; }
};

/// The tree of F - 1 merges given in merge order: fills `order`, `begin` and `end`. The merges are
/// trusted (children exist, each is used once); `import_tree` is for those that are not.
PartTree make_tree(int face_count, std::vector<int32_t> left, std::vector<int32_t> right);

/// The tree induced on some of the faces: leaf i is face representatives[i], and every node of
/// `tree` that separates two of them is a merge, in the order of `tree`. A face that does not exist
/// or is named twice is an `Error::invalid_tree`. O(F).
Result<PartTree> restrict_tree(const PartTree& tree, const std::vector<int32_t>& representatives);

}  // namespace partuv
