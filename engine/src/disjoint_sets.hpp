#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace partuv {

/// Sets of the numbers 0 .. count - 1 that are joined pair by pair; a set's name is its smallest
/// member, so that names do not depend on the order of the joins.
class DisjointSets {
 public:
  explicit DisjointSets(int count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  /// False if the two were in one set already.
  bool join(int i, int j) {
    const int a = find(i), b = find(j);
    parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<int32_t> parent_;
};

}  // namespace partuv
