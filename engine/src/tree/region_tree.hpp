#pragma once

#include <cstdint>
#include <vector>

#include "partuv/types.hpp"

namespace partuv {

struct Region {
  double area = 0.0;
  Vec3 mean = Vec3::Zero();
};

/// Regions in a k-d tree that answers "which other region is cheapest to join by Ward's criterion"
/// while regions are being joined. Subtrees hold similar areas in a compact place; each bounds its
/// means by a box and its areas from below; a join refits the two paths to the root, and the tree
/// is built anew as regions disappear.
class RegionTree {
 public:
  explicit RegionTree(std::vector<Region> regions);

  bool alive(int region) const { return leaf_[region] >= 0; }

  /// Ward's cost: area(a) area(b) / (area(a) + area(b)) |mean(a) - mean(b)|^2, rounded.
  float cost(int a, int b) const;

  /// The living region that is cheapest to join with `region`. Of several as cheap `previous` (or
  /// -1), else the first.
  int nearest(int region, int previous) const;

  /// One of the two, which is returned, becomes the union; the other is no more.
  int merge(int a, int b);

 private:
  struct Node {
    Vec3 low, high;
    double least_area;
    int32_t parent = -1, child[2] = {-1, -1};
    int32_t begin = 0, end = 0;  ///< of a leaf: its regions in items_
  };

  struct Candidate {
    int32_t region;
    float cost;
  };

  void build();
  int build_node(int begin, int end, int parent);
  int split_axis(int begin, int end) const;
  void fit(Node& node) const;
  void refit_from(int leaf);
  void look_in_leaf(const Node& leaf, int region, int previous, Candidate& best) const;
  float least_cost(const Node& node, const Region& region) const;
  float ward_cost(double area_a, double area_b, double squared_distance) const;

  std::vector<Region> regions_;
  std::vector<int32_t> leaf_;   // per region: its leaf, -1 once it is gone
  std::vector<int32_t> items_;  // the regions, leaf by leaf
  std::vector<Node> nodes_;
  double negligible_ = 0.0;  // squared distance that is none but for rounding
  int living_ = 0, living_at_build_ = 0;
};

}  // namespace partuv
