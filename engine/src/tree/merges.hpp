#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "partuv/tree.hpp"

namespace partuv {

/// The merges of a tree being built from the faces up.
class Merges {
 public:
  explicit Merges(int face_count) : face_count_(face_count) {
    left_.reserve(std::max(face_count - 1, 0));
    right_.reserve(std::max(face_count - 1, 0));
  }

  /// Join two nodes, the smaller one left; returns the new node.
  int join(int a, int b) {
    left_.push_back(std::min(a, b));
    right_.push_back(std::max(a, b));
    return face_count_ + count() - 1;
  }

  int count() const { return static_cast<int>(left_.size()); }
  int left(int merge) const { return left_[merge]; }
  PartTree finish() && { return make_tree(face_count_, std::move(left_), std::move(right_)); }

 private:
  int face_count_;
  std::vector<int32_t> left_, right_;
};

/// Join the roots of the connected components, once each is one subtree, by Ward's criterion on
/// area and mean position. Expected O(F + C log C) for C components.
void join_components(const Surface& surface, const std::vector<double>& area, Merges& merges,
                     const Context& context);

/// A tree that only pairs faces off as they come: for a caller that no longer cares.
PartTree pair_off(int face_count);

}  // namespace partuv
