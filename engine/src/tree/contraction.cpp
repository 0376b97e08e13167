#include "tree/contraction.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace partuv {

ContractionGraph::ContractionGraph(int slots, const std::vector<DualEdge>& edges)
    : head_(slots, -1), degree_(slots, 0) {
  edges_.reserve(edges.size());
  next_.reserve(2 * edges.size());
  previous_.reserve(2 * edges.size());
  table_.assign(std::bit_ceil(4 * edges.size() + 1), -1);
  for (const DualEdge& e : edges) {
    const double weight = e.length * e.similarity;
    const int twin = find(e.a, e.b);
    if (twin >= 0) {
      edges_[twin].weight += weight;
      continue;
    }
    const int added = edge_count();
    edges_.push_back({{e.a, e.b}, weight});
    next_.insert(next_.end(), 2, -1);
    previous_.insert(previous_.end(), 2, -1);
    ++living_;
    link(2 * added);
    link(2 * added + 1);
    insert(added);
  }
}

void ContractionGraph::link(int half_edge) {
  const int slot = edges_[half_edge / 2].slot[half_edge % 2];
  next_[half_edge] = head_[slot];
  previous_[half_edge] = -1;
  if (head_[slot] >= 0) previous_[head_[slot]] = half_edge;
  head_[slot] = half_edge;
  ++degree_[slot];
}

void ContractionGraph::unlink(int half_edge) {
  const int slot = edges_[half_edge / 2].slot[half_edge % 2];
  const int next = next_[half_edge], previous = previous_[half_edge];
  (previous >= 0 ? next_[previous] : head_[slot]) = next;
  if (next >= 0) previous_[next] = previous;
  --degree_[slot];
}

size_t ContractionGraph::position(int32_t a, int32_t b) const {
  const auto [low, high] = std::minmax(a, b);
  uint64_t key = (static_cast<uint64_t>(low) << 32) | static_cast<uint32_t>(high);
  key *= 0x9E3779B97F4A7C15u;  // Fibonacci hashing (Knuth, TAOCP 6.4)
  key ^= key >> 32;
  return key & (table_.size() - 1);
}

int ContractionGraph::find(int32_t a, int32_t b) const {
  for (size_t i = position(a, b);; i = (i + 1) & (table_.size() - 1)) {
    const int e = table_[i];
    if (e < 0) return -1;
    const Edge& edge = edges_[e];
    if ((edge.slot[0] == a && edge.slot[1] == b) || (edge.slot[0] == b && edge.slot[1] == a)) {
      return e;
    }
  }
}

void ContractionGraph::insert(int e) {
  if (2 * (table_used_ + 1) > table_.size()) {
    rebuild_table();
    return;
  }
  size_t i = position(edges_[e].slot[0], edges_[e].slot[1]);
  while (table_[i] >= 0) i = (i + 1) & (table_.size() - 1);
  table_[i] = e;
  ++table_used_;
}

void ContractionGraph::rebuild_table() {
  table_.assign(std::bit_ceil(4 * static_cast<size_t>(living_) + 1024), -1);
  table_used_ = 0;
  for (int e = 0; e < edge_count(); ++e) {
    if (!alive(e)) continue;
    size_t i = position(edges_[e].slot[0], edges_[e].slot[1]);
    while (table_[i] >= 0) i = (i + 1) & (table_.size() - 1);
    table_[i] = e;
    ++table_used_;
  }
}

}  // namespace partuv
