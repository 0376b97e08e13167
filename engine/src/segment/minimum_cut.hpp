#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"

namespace partuv {

/// Minimum cut between two terminals in an undirected graph with integer capacities (Dinic 1970).
/// Suits narrow planar strips: as many phases as the strip is wide. Keeps its memory between cuts.
class MinimumCut {
 public:
  static constexpr int source = 0, sink = 1, first_node = 2;

  /// Forget the graph and begin one with this many nodes besides the terminals.
  void reset(int nodes);
  void add_edge(int a, int b, int32_t capacity);
  /// Find the cut, unless the context is cancelled. Afterwards `on_source_side` tells for each node
  /// where it is: of the cheapest cuts the one nearest to the source.
  void solve(const Context& context);
  bool on_source_side(int node) const { return level_[node] >= 0; }

 private:
  bool find_levels();
  int64_t augment();

  struct Arc {
    int32_t to, next, capacity;
  };
  std::vector<Arc> arcs_;  ///< the reverse of arc i is i ^ 1
  std::vector<int32_t> first_, current_, level_, queue_, path_;
};

}  // namespace partuv
