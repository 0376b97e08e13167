#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "partuv/tree.hpp"

namespace partuv {

/// One merge of a tree made elsewhere: the entry `id: {left, right}`.
struct ImportedNode {
  int64_t id, left, right;
};

/// A tree over F faces from its F - 1 merges in any order. The ids are F..2F-2, each once; children
/// are faces or older merges, and everything but the root 2F-2 is a child once. What breaks this is
/// named in the failure (`Error::invalid_tree`). O(F).
Result<PartTree> import_tree(int face_count, std::span<const ImportedNode> nodes);

/// The same from a PartUV tree file: little-endian 32-bit integers, the number of merges and then
/// id, left, right of each, nothing else. The size is checked before anything is allocated.
Result<PartTree> read_tree_file(int face_count, std::span<const std::byte> file);

}  // namespace partuv
