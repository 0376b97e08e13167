#include "flatten/ordering.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace partuv {
namespace {

/// Approximate minimum degree (Amestoy, Davis, Duff 1996).
std::vector<int32_t> minimum_degree_order(const VertexGraph& graph) {
  const int n = graph.vertex_count();
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.resizeNonZeros(static_cast<Eigen::Index>(graph.other.size()));
  std::copy(graph.first.begin(), graph.first.end(), pattern.outerIndexPtr());
  std::copy(graph.other.begin(), graph.other.end(), pattern.innerIndexPtr());
  std::fill_n(pattern.valuePtr(), graph.other.size(), 1.0);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  // The public AMDOrdering would first make the pattern symmetric, which it is.
  Eigen::internal::minimum_degree_ordering(pattern, order);
  return {order.indices().data(), order.indices().data() + n};
}

std::vector<int32_t> ranks(const std::vector<int32_t>& order) {
  std::vector<int32_t> rank(order.size());
  for (size_t r = 0; r < order.size(); ++r) rank[order[r]] = static_cast<int32_t>(r);
  return rank;
}

/// Parent of each place in the elimination tree, -1 at a root (Liu 1990).
std::vector<int32_t> elimination_tree(const VertexGraph& graph, const std::vector<int32_t>& order) {
  const std::vector<int32_t> rank = ranks(order);
  std::vector<int32_t> parent(order.size(), -1), ancestor(order.size(), -1);
  for (int k = 0; k < static_cast<int>(order.size()); ++k) {
    for (int p = graph.first[order[k]]; p < graph.first[order[k] + 1]; ++p) {
      for (int i = rank[graph.other[p]]; i < k;) {
        const int above = ancestor[i];
        ancestor[i] = k;
        if (above < 0) parent[i] = k;
        i = above < 0 ? k : above;
      }
    }
  }
  return parent;
}

/// The places of a tree, each after all below it and right after the last of them.
std::vector<int32_t> postorder(const std::vector<int32_t>& parent) {
  const int n = static_cast<int>(parent.size());
  // Children of each as lists, the first child first; the roots' are at the end.
  std::vector<int32_t> child(n + 1, -1), sibling(n, -1);
  for (int k = n - 1; k >= 0; --k) {
    int32_t& first = child[parent[k] < 0 ? n : parent[k]];
    sibling[k] = first;
    first = k;
  }
  std::vector<int32_t> result, open;
  result.reserve(n);
  for (int root = child[n]; root >= 0; root = sibling[root]) {
    open.push_back(root);
    while (!open.empty()) {
      const int at = open.back();
      if (child[at] >= 0) {
        open.push_back(child[at]);
        child[at] = sibling[child[at]];
      } else {
        result.push_back(at);
        open.pop_back();
      }
    }
  }
  return result;
}

}  // namespace

Elimination plan_elimination(const VertexGraph& graph) {
  const int n = graph.vertex_count();
  const std::vector<int32_t> first_order = minimum_degree_order(graph);
  const std::vector<int32_t> parent = elimination_tree(graph, first_order);
  const std::vector<int32_t> place = postorder(parent), new_place = ranks(place);
  std::vector<int32_t> order(n);
  Elimination plan;
  LowerPattern& lower = plan.pattern;
  lower.parent.resize(n);
  for (int r = 0; r < n; ++r) {
    order[r] = first_order[place[r]];
    lower.parent[r] = parent[place[r]] < 0 ? -1 : new_place[parent[place[r]]];
  }
  plan.rank = ranks(order);
  // By ascending columns, so that the rows come out sorted.
  lower.start.assign(n + 1, 0);
  const auto each_entry = [&](auto&& visit) {
    for (int c = 0; c < n; ++c) {
      for (int p = graph.first[order[c]]; p < graph.first[order[c] + 1]; ++p) {
        const int row = plan.rank[graph.other[p]];
        if (row > c) visit(row, c);
      }
    }
  };
  each_entry([&](int row, int) { ++lower.start[row + 1]; });
  for (int r = 0; r < n; ++r) lower.start[r + 1] += lower.start[r];
  lower.before.resize(lower.start.back());
  std::vector<int32_t> fill(lower.start.begin(), lower.start.end() - 1);
  each_entry([&](int row, int column) { lower.before[fill[row]++] = column; });
  return plan;
}

}  // namespace partuv
