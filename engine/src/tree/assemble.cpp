#include <algorithm>
#include <string>
#include <utility>

#include "partuv/tree.hpp"

namespace partuv {

PartTree make_tree(int face_count, std::vector<int32_t> left, std::vector<int32_t> right) {
  PartTree tree;
  tree.face_count = face_count;
  tree.left = std::move(left);
  tree.right = std::move(right);
  if (face_count == 0) return tree;
  const int nodes = 2 * face_count - 1;
  tree.begin.assign(nodes, 0);
  tree.end.assign(nodes, 1);  // sizes, until the intervals are known
  for (int node = face_count; node < nodes; ++node) {
    const int i = node - face_count;
    tree.end[node] = tree.end[tree.left[i]] + tree.end[tree.right[i]];
  }
  for (int node = nodes - 1; node >= face_count; --node) {
    const int i = node - face_count;
    tree.begin[tree.left[i]] = tree.begin[node];
    tree.begin[tree.right[i]] = tree.begin[node] + tree.end[tree.left[i]];
  }
  for (int node = 0; node < nodes; ++node) tree.end[node] += tree.begin[node];
  tree.order.resize(face_count);
  for (int face = 0; face < face_count; ++face) tree.order[tree.begin[face]] = face;
  return tree;
}

Result<PartTree> restrict_tree(const PartTree& tree, const std::vector<int32_t>& representatives) {
  const int leaves = static_cast<int>(representatives.size());
  std::vector<int32_t> node_of(tree.begin.size(), -1);
  for (int i = 0; i < leaves; ++i) {
    const int face = representatives[i];
    if (face < 0 || face >= tree.face_count || node_of[face] >= 0) {
      return Failure{Error::invalid_tree, "representative " + std::to_string(i) + ": face " +
                                              std::to_string(face) + " is no face of its own"};
    }
    node_of[face] = i;
  }
  std::vector<int32_t> left, right;
  left.reserve(std::max(leaves - 1, 0));
  right.reserve(std::max(leaves - 1, 0));
  for (int i = 0; i + 1 < tree.face_count; ++i) {
    const int a = node_of[tree.left[i]], b = node_of[tree.right[i]];
    if (a < 0 || b < 0) {
      node_of[tree.face_count + i] = std::max(a, b);
      continue;
    }
    node_of[tree.face_count + i] = leaves + static_cast<int>(left.size());
    left.push_back(a);
    right.push_back(b);
  }
  return make_tree(leaves, std::move(left), std::move(right));
}

}  // namespace partuv
