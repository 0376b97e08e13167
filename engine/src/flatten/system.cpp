#include "flatten/system.hpp"

#include <algorithm>

#include "buckets.hpp"
#include "flatten/ordering.hpp"

namespace partuv {
namespace {

/// Every face lists its pairs, then each vertex keeps the first of equals.
VertexGraph vertex_graph(const std::vector<Triangle>& faces, int vertex_count) {
  const Buckets<int32_t> others = grouped<int32_t>(vertex_count, [&](auto&& visit) {
    for (const Triangle& t : faces) {
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        if (a < 0 || b < 0) continue;
        visit(a, b);
        visit(b, a);
      }
    }
  });
  VertexGraph graph{{0}, {}};
  graph.first.reserve(vertex_count + 1);
  graph.other.reserve(others.items.size() / 2 + 2 * vertex_count);
  std::vector<int32_t> listed_by(vertex_count, -1);
  for (int v = 0; v < vertex_count; ++v) {
    listed_by[v] = v;
    graph.other.push_back(v);
    for (int i = others.start[v]; i < others.start[v + 1]; ++i) {
      const int32_t other = others.items[i];
      if (listed_by[other] == v) continue;
      listed_by[other] = v;
      graph.other.push_back(other);
    }
    graph.first.push_back(static_cast<int32_t>(graph.other.size()));
  }
  return graph;
}

}  // namespace

template <int D>
MeshSystem<D>::MeshSystem(std::vector<Triangle> faces, int vertex_count)
    : faces_(std::move(faces)) {
  const VertexGraph graph = vertex_graph(faces_, vertex_count);
  Elimination plan = plan_elimination(graph);
  rank_ = std::move(plan.rank);
  const LowerPattern& lower = plan.pattern;
  pair_place_.assign(faces_.size(), {-1, -1, -1});
  for (size_t f = 0; f < faces_.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = faces_[f][k], b = faces_[f][(k + 1) % 3];
      if (a < 0 || b < 0) continue;
      const int low = std::min(rank_[a], rank_[b]), high = std::max(rank_[a], rank_[b]);
      const auto from = lower.before.begin() + lower.start[high];
      const auto to = lower.before.begin() + lower.start[high + 1];
      // Most rows have a few entries, which are found faster one after the other.
      constexpr int few = 12;
      const auto at = to - from <= few ? std::find(from, to, low) : std::lower_bound(from, to, low);
      pair_place_[f][k] = static_cast<int32_t>(at - lower.before.begin());
    }
  }
  diagonal_.assign(static_cast<size_t>(vertex_count) * block, 0.0);
  lower_.assign(lower.before.size() * block, 0.0);
  solver_.analyse(lower);
}

template <int D>
void MeshSystem<D>::clear() {
  std::fill(diagonal_.begin(), diagonal_.end(), 0.0);
  std::fill(lower_.begin(), lower_.end(), 0.0);
}

template <int D>
void MeshSystem<D>::add_diagonal(int vertex, int dof, double value) {
  diagonal_[static_cast<size_t>(rank_[vertex]) * block + dof * (D + 1)] += value;
}

template <int D>
double MeshSystem<D>::mean_diagonal() const {
  double sum = 0.0;
  for (size_t v = 0; v < rank_.size(); ++v) {
    for (int d = 0; d < D; ++d) sum += diagonal_[v * block + d * (D + 1)];
  }
  return rank_.empty() ? 0.0 : sum / static_cast<double>(D * rank_.size());
}

template <int D>
bool MeshSystem<D>::factor(double shift, const Context& context) {
  for (size_t v = 0; v < rank_.size(); ++v) {
    for (int d = 0; d < D; ++d) diagonal_[v * block + d * (D + 1)] += shift;
  }
  return solver_.factor(diagonal_, lower_, context);
}

template <int D>
Eigen::VectorXd MeshSystem<D>::solve(const Eigen::VectorXd& rhs) const {
  Eigen::VectorXd permuted(rhs.size()), result(rhs.size());
  for (size_t v = 0; v < rank_.size(); ++v) {
    permuted.segment<D>(D * rank_[v]) = rhs.segment<D>(D * v);
  }
  solver_.solve(permuted.data());
  for (size_t v = 0; v < rank_.size(); ++v) {
    result.segment<D>(D * v) = permuted.segment<D>(D * rank_[v]);
  }
  return result;
}

template class MeshSystem<1>;
template class MeshSystem<2>;

}  // namespace partuv
