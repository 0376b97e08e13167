#include "segment/minimum_cut.hpp"

#include <algorithm>
#include <limits>

namespace partuv {

void MinimumCut::reset(int nodes) {
  arcs_.clear();
  first_.assign(first_node + nodes, -1);
}

void MinimumCut::add_edge(int a, int b, int32_t capacity) {
  const auto add = [&](int from, int to) {
    arcs_.push_back({to, first_[from], capacity});
    first_[from] = static_cast<int32_t>(arcs_.size()) - 1;
  };
  add(a, b);
  add(b, a);
}

/// Breadth-first distances from the source in the residual graph; false if the sink is cut off.
bool MinimumCut::find_levels() {
  level_.assign(first_.size(), -1);
  queue_.assign(1, source);
  level_[source] = 0;
  for (size_t i = 0; i < queue_.size(); ++i) {
    const int node = queue_[i];
    for (int a = first_[node]; a >= 0; a = arcs_[a].next) {
      const int to = arcs_[a].to;
      if (arcs_[a].capacity <= 0 || level_[to] >= 0) continue;
      level_[to] = level_[node] + 1;
      if (to == sink) return true;  // no shortest path leads through what lies beyond
      queue_.push_back(to);
    }
  }
  return false;
}

/// Push flow along one shortest path; 0 when there is none left.
int64_t MinimumCut::augment() {
  path_.clear();
  int node = source;
  while (node != sink) {
    int& a = current_[node];
    while (a >= 0 && (arcs_[a].capacity <= 0 || level_[arcs_[a].to] != level_[node] + 1)) {
      a = arcs_[a].next;
    }
    if (a >= 0) {
      path_.push_back(a);
      node = arcs_[a].to;
      continue;
    }
    if (path_.empty()) return 0;
    level_[node] = -1;  // a dead end in this phase
    node = arcs_[path_.back() ^ 1].to;
    path_.pop_back();
  }
  int32_t flow = std::numeric_limits<int32_t>::max();
  for (const int a : path_) flow = std::min(flow, arcs_[a].capacity);
  for (const int a : path_) {
    arcs_[a].capacity -= flow;
    arcs_[a ^ 1].capacity += flow;
  }
  return flow;
}

void MinimumCut::solve(const Context& context) {
  while (find_levels() && !context.cancelled()) {
    current_ = first_;
    while (augment() > 0) {
    }
  }
}

}  // namespace partuv
