#include <string>
#include <utility>
#include <vector>

#include "partuv/tree_import.hpp"

namespace partuv {

namespace {

constexpr size_t integer_bytes = 4;
constexpr size_t node_bytes = 3 * integer_bytes;

Failure invalid(const std::string& where) { return {Error::invalid_tree, where}; }

std::string node_name(int64_t id) { return "node " + std::to_string(id); }

std::string merges_wanted(int face_count) {
  return "expected " + std::to_string(face_count - 1) + " for " + std::to_string(face_count) +
         " faces";
}

int32_t little_endian(std::span<const std::byte> bytes) {
  uint32_t value = 0;
  for (size_t i = 0; i < integer_bytes; ++i) {
    value |= std::to_integer<uint32_t>(bytes[i]) << (8 * i);
  }
  return static_cast<int32_t>(value);
}

}  // namespace

Result<PartTree> import_tree(int face_count, std::span<const ImportedNode> nodes) {
  if (face_count < 1) return invalid("tree of no faces");
  if (nodes.size() != static_cast<size_t>(face_count - 1)) {
    return invalid(std::to_string(nodes.size()) + " merges, " + merges_wanted(face_count));
  }
  const int64_t root = 2 * static_cast<int64_t>(face_count) - 2;
  std::vector<int32_t> left(nodes.size(), -1), right(nodes.size(), -1);
  std::vector<char> is_child(root + 1, 0);
  for (const ImportedNode& node : nodes) {
    if (node.id < face_count || node.id > root) {
      return invalid(node_name(node.id) + ": merges are numbered " + std::to_string(face_count) +
                     " to " + std::to_string(root));
    }
    if (left[node.id - face_count] >= 0) return invalid(node_name(node.id) + ": given twice");
    for (const int64_t child : {node.left, node.right}) {
      if (child < 0 || child >= node.id) {
        return invalid(node_name(node.id) + ": child " + std::to_string(child) +
                       " is neither a face nor an older merge");
      }
      if (is_child[child]) return invalid(node_name(child) + ": child of two merges");
      is_child[child] = 1;
    }
    left[node.id - face_count] = static_cast<int32_t>(node.left);
    right[node.id - face_count] = static_cast<int32_t>(node.right);
  }
  // F - 1 distinct merges with 2F - 2 distinct, older children: all that is left to be is a tree.
  return make_tree(face_count, std::move(left), std::move(right));
}

Result<PartTree> read_tree_file(int face_count, std::span<const std::byte> file) {
  if (face_count < 1) return invalid("tree of no faces");
  if (file.size() < integer_bytes) return invalid("tree file: no header");
  const int32_t count = little_endian(file);
  if (count != face_count - 1) {
    return invalid("tree file: " + std::to_string(count) + " merges, " + merges_wanted(face_count));
  }
  const size_t expected = integer_bytes + node_bytes * static_cast<size_t>(count);
  if (file.size() != expected) {
    return invalid("tree file: " + std::to_string(file.size()) + " bytes, expected " +
                   std::to_string(expected));
  }
  std::vector<ImportedNode> nodes(count);
  for (size_t i = 0; i < nodes.size(); ++i) {
    const auto bytes = file.subspan(integer_bytes + i * node_bytes, node_bytes);
    nodes[i] = {little_endian(bytes), little_endian(bytes.subspan(integer_bytes)),
                little_endian(bytes.subspan(2 * integer_bytes))};
  }
  return import_tree(face_count, nodes);
}

}  // namespace partuv
