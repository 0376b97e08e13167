#include <algorithm>

#include "partuv/tree_cut.hpp"

namespace partuv {

void number_by_first_face(std::vector<int32_t>& labels) {
  if (labels.empty()) return;
  std::vector<int32_t> number(*std::max_element(labels.begin(), labels.end()) + 1, -1);
  int count = 0;
  for (int32_t& label : labels) {
    if (number[label] < 0) number[label] = count++;
    label = number[label];
  }
}

std::vector<int32_t> cut_tree(const PartTree& tree, int parts) {
  const int faces = tree.face_count;
  const int undone = std::clamp(parts, 1, std::max(faces, 1)) - 1;
  const int kept = std::max(2 * faces - 1 - undone, 0);  // nodes below: whole
  std::vector<int32_t> labels(faces, 0);
  int count = 0;
  auto label_if_whole = [&](int node) {
    if (node >= kept) return;
    for (int i = tree.begin[node]; i < tree.end[node]; ++i) labels[tree.order[i]] = count;
    ++count;
  };
  for (int node = kept; node <= tree.root(); ++node) {
    label_if_whole(tree.left[node - faces]);
    label_if_whole(tree.right[node - faces]);
  }
  number_by_first_face(labels);
  return labels;
}

std::vector<int32_t> labels_of_mesh(const Topology& topology, const std::vector<int32_t>& labels) {
  std::vector<int32_t> result(topology.welded.size(), 0);
  for (size_t f = 0; f < labels.size(); ++f) result[topology.source_face[f]] = labels[f];
  if (topology.collapsed.empty()) return result;
  int points = 0;
  for (const Triangle& t : topology.welded)
    points = std::max({points, t[0] + 1, t[1] + 1, t[2] + 1});
  std::vector<int32_t> label_of_point(points, -1);
  for (size_t f = labels.size(); f-- > 0;) {  // the smallest face wins
    for (const int p : topology.welded[topology.source_face[f]]) label_of_point[p] = labels[f];
  }
  for (const int f : topology.collapsed) {
    for (const int p : topology.welded[f]) {
      if (label_of_point[p] < 0) continue;
      result[f] = label_of_point[p];
      break;
    }
  }
  return result;
}

}  // namespace partuv
