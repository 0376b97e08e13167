#include <algorithm>
#include <utility>

#include "partuv/tree_cut.hpp"
#include "tree/dual_graph.hpp"

namespace partuv {

namespace {

/// What is left of a tree when merges with a side too small to be a part are passed over: a stem is
/// a run of such merges, and ends where the tree forks into two stems or below where nothing does.
struct Stem {
  int32_t parent = -1;
  int32_t child[2] = {-1, -1};
  double area = 0.0;         // share of the whole
  double conductance = 0.0;  // between the two children
};

class StemTree {
 public:
  StemTree(const PartTree& tree, const std::vector<double>& face_area, double least_area);

  /// Adds up what connects the two sides of each fork.
  void conduct(const std::vector<DualEdge>& edges);

  /// Part of each face where forks that conduct less than `most` per area are opened; -1 for faces
  /// that belong to an opened stem itself.
  std::vector<int32_t> open_below(double most) const;

 private:
  std::vector<Stem> stems_;  // parents before children
  std::vector<int32_t> stem_of_face_;
};

StemTree::StemTree(const PartTree& tree, const std::vector<double>& face_area, double least_area)
    : stem_of_face_(tree.face_count) {
  const int faces = tree.face_count, nodes = static_cast<int>(tree.begin.size());
  std::vector<double> area(face_area);
  area.reserve(nodes);
  for (int i = 0; i + faces < nodes; ++i) {
    area.push_back(area[tree.left[i]] + area[tree.right[i]]);
  }
  std::vector<int32_t> stem(nodes, 0);
  stems_.push_back({.area = area.back()});
  for (int node = nodes - 1; node >= faces; --node) {
    const int sides[2] = {tree.left[node - faces], tree.right[node - faces]};
    const bool fork = std::min(area[sides[0]], area[sides[1]]) >= least_area;
    for (int side = 0; side < 2; ++side) {
      stem[sides[side]] = stem[node];
      if (!fork) continue;
      stem[sides[side]] = static_cast<int32_t>(stems_.size());
      stems_[stem[node]].child[side] = stem[sides[side]];
      stems_.push_back({.parent = stem[node], .area = area[sides[side]]});
    }
  }
  std::copy_n(stem.begin(), faces, stem_of_face_.begin());
}

void StemTree::conduct(const std::vector<DualEdge>& edges) {
  for (const DualEdge& e : edges) {
    int a = stem_of_face_[e.a], b = stem_of_face_[e.b];
    bool from_below_a = false, from_below_b = false;
    while (a != b) {  // the larger number is not above the other
      bool& from_below = a > b ? from_below_a : from_below_b;
      int& stem = a > b ? a : b;
      stem = stems_[stem].parent;
      from_below = true;
    }
    if (from_below_a && from_below_b) stems_[a].conductance += e.length * e.similarity;
  }
}

std::vector<int32_t> StemTree::open_below(double most) const {
  std::vector<int32_t> part(stems_.size(), 0);
  for (size_t s = 0; s < stems_.size(); ++s) {
    const Stem& stem = stems_[s];
    const bool inside_part = stem.parent >= 0 && part[stem.parent] >= 0;
    part[s] = inside_part ? part[stem.parent] : static_cast<int32_t>(s);
    if (inside_part || stem.child[0] < 0) continue;
    const double areas = 1.0 / stems_[stem.child[0]].area + 1.0 / stems_[stem.child[1]].area;
    if (stem.conductance * areas < most) part[s] = -1;
  }
  std::vector<int32_t> labels(stem_of_face_.size());
  for (size_t f = 0; f < labels.size(); ++f) labels[f] = part[stem_of_face_[f]];
  return labels;
}

/// Faces without a label take that of their neighbours, nearest first.
void spread_across_sides(const Surface& surface, std::vector<int32_t>& labels) {
  std::vector<int32_t> queue;
  for (size_t f = 0; f < labels.size(); ++f) {
    if (labels[f] >= 0) queue.push_back(static_cast<int32_t>(f));
  }
  for (size_t i = 0; i < queue.size(); ++i) {
    for (const int o : surface.opposite[queue[i]]) {
      if (o < 0 || labels[o / 3] >= 0) continue;
      labels[o / 3] = labels[queue[i]];
      queue.push_back(o / 3);
    }
  }
}

/// What is still without a label touches nothing that has one: it takes that of its neighbour in
/// leaf order, where near components stand together.
void spread_in_leaf_order(const PartTree& tree, std::vector<int32_t>& labels) {
  int32_t last = -1;
  for (const int f : tree.order) last = labels[f] = labels[f] >= 0 ? labels[f] : last;
  for (auto f = tree.order.rbegin(); f != tree.order.rend(); ++f) {
    last = labels[*f] = labels[*f] >= 0 ? labels[*f] : last;
  }
}

}  // namespace

std::vector<int32_t> cut_tree_auto(const PartTree& tree, const Surface& surface,
                                   const PartCutOptions& options) {
  if (tree.face_count == 0) return {};
  StemTree stems(tree, area_shares(surface, {}), options.least_area);
  stems.conduct(crease_edges(surface, options.creases));
  std::vector<int32_t> labels = stems.open_below(options.most_conductance);
  spread_across_sides(surface, labels);
  spread_in_leaf_order(tree, labels);
  number_by_first_face(labels);
  return labels;
}

}  // namespace partuv
