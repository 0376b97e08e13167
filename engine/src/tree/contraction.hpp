#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "tree/dual_graph.hpp"

namespace partuv {

/// A face graph whose edges are contracted one after the other. Regions live in slots: the slot of
/// the better connected one survives a contraction, so that O(E log E) half-edges are relabelled in
/// all. Parallel edges are folded into one, their weights added.
class ContractionGraph {
 public:
  struct Edge {
    int32_t slot[2];  ///< -1, -1 once it is gone
    double weight;
  };

  ContractionGraph(int slots, const std::vector<DualEdge>& edges);

  int slot_count() const { return static_cast<int>(head_.size()); }
  int living_edge_count() const { return living_; }
  int degree(int slot) const { return degree_[slot]; }
  int edge_count() const { return static_cast<int>(edges_.size()); }
  const Edge& edge(int e) const { return edges_[e]; }
  bool alive(int e) const { return edges_[e].slot[0] >= 0; }

  /// Contract a living edge and return the slot that survives. `changed(e, folded)` is called for
  /// each edge that took the weight of another one (folded) or came over from the other slot.
  template <typename Changed>
  int contract(int e, Changed&& changed);

  /// Call visit(edge, other slot) for each edge of a slot.
  template <typename Visit>
  void for_each_edge(int slot, Visit&& visit) const {
    for (int h = head_[slot]; h >= 0; h = next_[h]) visit(h / 2, edges_[h / 2].slot[1 - h % 2]);
  }

 private:
  // Half-edge 2 * e + side, in the list of edges_[e].slot[side].
  void link(int half_edge);
  void unlink(int half_edge);

  int find(int32_t a, int32_t b) const;
  void insert(int e);
  void rebuild_table();
  size_t position(int32_t a, int32_t b) const;

  std::vector<Edge> edges_;
  std::vector<int32_t> next_, previous_;  // per half-edge
  std::vector<int32_t> head_, degree_;    // per slot
  // Open addressing from a pair of slots to its edge. An entry whose edge has moved on to another
  // pair stays behind as a tombstone until the table is rebuilt.
  std::vector<int32_t> table_;
  size_t table_used_ = 0;
  int living_ = 0;
};

template <typename Changed>
int ContractionGraph::contract(int e, Changed&& changed) {
  const bool swap = degree_[edges_[e].slot[0]] < degree_[edges_[e].slot[1]] ||
                    (degree_[edges_[e].slot[0]] == degree_[edges_[e].slot[1]] &&
                     edges_[e].slot[1] < edges_[e].slot[0]);
  const int keep = edges_[e].slot[swap ? 1 : 0], gone = edges_[e].slot[swap ? 0 : 1];
  for (int h = head_[gone]; h >= 0;) {
    const int next = next_[h];
    const int moved = h / 2, side = h % 2, other = edges_[moved].slot[1 - side];
    const int twin = other == keep ? moved : find(keep, other);
    unlink(h);
    if (twin >= 0) {
      if (twin != moved) edges_[twin].weight += edges_[moved].weight;
      unlink(h ^ 1);
      edges_[moved].slot[0] = edges_[moved].slot[1] = -1;
      --living_;
      if (twin != moved) changed(twin, true);
    } else {
      edges_[moved].slot[side] = keep;
      link(h);
      insert(moved);
      changed(moved, false);
    }
    h = next;
  }
  return keep;
}

/// Contract all edges whatever they weigh, in rounds that touch a region once as long as that gets
/// somewhere, for the balance; `join(e)` is called before each. Gives up when it is cancelled.
template <typename Join>
void contract_in_rounds(ContractionGraph& graph, const Context& context, Join&& join) {
  constexpr int balanced_rounds = 32;
  std::vector<int32_t> touched(graph.slot_count(), -1);
  for (int round = 0; round <= balanced_rounds && !context.cancelled(); ++round) {
    for (int e = 0; e < graph.edge_count(); ++e) {
      if (!graph.alive(e)) continue;
      const auto [a, b] = graph.edge(e).slot;
      if (round < balanced_rounds && (touched[a] == round || touched[b] == round)) continue;
      touched[a] = touched[b] = round;
      join(e);
      graph.contract(e, [](int, bool) {});
    }
  }
}

}  // namespace partuv
