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
  Eigen::AMDOrdering<int>()(pattern, order);
  return {order.indices().data(), order.indices().data() + n};
}

}  // namespace

LowerPattern lower_pattern(const VertexGraph& graph, const std::vector<int32_t>& order) {
  const int n = graph.vertex_count();
  std::vector<int32_t> rank(n);
  for (int r = 0; r < n; ++r) rank[order[r]] = r;
  LowerPattern lower;
  lower.start.assign(n + 1, 0);
  lower.before.reserve(graph.other.size() / 2);
  for (int r = 0; r < n; ++r) {
    for (int p = graph.first[order[r]]; p < graph.first[order[r] + 1]; ++p) {
      const int earlier = rank[graph.other[p]];
      if (earlier < r) lower.before.push_back(earlier);
    }
    std::sort(lower.before.begin() + lower.start[r], lower.before.end());
    lower.start[r + 1] = static_cast<int32_t>(lower.before.size());
  }
  return lower;
}

std::vector<int32_t> postordered(const VertexGraph& graph, const std::vector<int32_t>& order) {
  const int n = graph.vertex_count();
  const std::vector<int32_t> parent = elimination_tree(lower_pattern(graph, order));
  // Children of each column as lists, the first child first; the roots' are at the end.
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
        result.push_back(order[at]);
        open.pop_back();
      }
    }
  }
  return result;
}

std::vector<int32_t> elimination_order(const VertexGraph& graph) {
  return postordered(graph, minimum_degree_order(graph));
}

}  // namespace partuv
