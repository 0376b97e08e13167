#include "flatten/system.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>

namespace partuv {

MeshSystem::MeshSystem(const std::vector<Triangle>& faces, int vertex_count, int dofs)
    : dofs_(dofs), vertex_count_(vertex_count), faces_(faces) {
  // Vertex graph, both directions, as the ordering wants it.
  std::vector<Eigen::Triplet<double>> pairs;
  pairs.reserve(6 * faces.size() + vertex_count);
  for (int v = 0; v < vertex_count; ++v) pairs.emplace_back(v, v, 1.0);
  for (const Triangle& t : faces) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (a < 0 || b < 0) continue;
      pairs.emplace_back(a, b, 1.0);
      pairs.emplace_back(b, a, 1.0);
    }
  }
  Eigen::SparseMatrix<double> graph(vertex_count, vertex_count);
  graph.setFromTriplets(pairs.begin(), pairs.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int> amd;
  amd(graph, order);
  rank_.resize(vertex_count);
  for (int r = 0; r < vertex_count; ++r) rank_[order.indices()[r]] = r;

  std::vector<int32_t> vertex_at(vertex_count);
  for (int v = 0; v < vertex_count; ++v) vertex_at[rank_[v]] = v;
  start_.assign(vertex_count + 1, 0);
  for (int r = 0; r < vertex_count; ++r) {
    const size_t first = below_.size();
    for (Eigen::SparseMatrix<double>::InnerIterator it(graph, vertex_at[r]); it; ++it) {
      if (rank_[it.row()] > r) below_.push_back(rank_[it.row()]);
    }
    std::sort(below_.begin() + first, below_.end());
    start_[r + 1] = static_cast<int32_t>(below_.size());
  }
  pair_place_.assign(faces.size(), {-1, -1, -1});
  for (size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = faces[f][k], b = faces[f][(k + 1) % 3];
      if (a < 0 || b < 0) continue;
      const int low = std::min(rank_[a], rank_[b]), high = std::max(rank_[a], rank_[b]);
      const auto from = below_.begin() + start_[low], to = below_.begin() + start_[low + 1];
      pair_place_[f][k] = static_cast<int32_t>(std::lower_bound(from, to, high) - from);
    }
  }

  const int size = dofs * vertex_count;
  matrix_.resize(size, size);
  std::vector<int> counts(size);
  for (int r = 0; r < vertex_count; ++r) {
    for (int c = 0; c < dofs; ++c) {
      counts[dofs * r + c] = (dofs - c) + dofs * (start_[r + 1] - start_[r]);
    }
  }
  matrix_.reserve(counts);
  for (int r = 0; r < vertex_count; ++r) {
    for (int c = 0; c < dofs; ++c) {
      const int column = dofs * r + c;
      for (int d = c; d < dofs; ++d) matrix_.insert(dofs * r + d, column) = 0.0;
      for (int i = start_[r]; i < start_[r + 1]; ++i) {
        for (int d = 0; d < dofs; ++d) matrix_.insert(dofs * below_[i] + d, column) = 0.0;
      }
    }
  }
  matrix_.makeCompressed();
  solver_.analyzePattern(matrix_);
}

void MeshSystem::clear() {
  std::fill(matrix_.valuePtr(), matrix_.valuePtr() + matrix_.nonZeros(), 0.0);
}

void MeshSystem::add_diagonal(int vertex, int dof, double value) {
  matrix_.valuePtr()[matrix_.outerIndexPtr()[dofs_ * rank_[vertex] + dof]] += value;
}

double MeshSystem::mean_diagonal() const {
  double sum = 0.0;
  const int size = dofs_ * vertex_count_;
  for (int i = 0; i < size; ++i) sum += matrix_.valuePtr()[matrix_.outerIndexPtr()[i]];
  return size > 0 ? sum / size : 0.0;
}

bool MeshSystem::factor(double shift) {
  const int size = dofs_ * vertex_count_;
  for (int i = 0; i < size; ++i) matrix_.valuePtr()[matrix_.outerIndexPtr()[i]] += shift;
  solver_.factorize(matrix_);
  return solver_.info() == Eigen::Success;
}

Eigen::VectorXd MeshSystem::solve(const Eigen::VectorXd& rhs) const {
  Eigen::VectorXd permuted(rhs.size());
  for (int v = 0; v < vertex_count_; ++v) {
    for (int d = 0; d < dofs_; ++d) permuted[dofs_ * rank_[v] + d] = rhs[dofs_ * v + d];
  }
  const Eigen::VectorXd found = solver_.solve(permuted);
  Eigen::VectorXd result(rhs.size());
  for (int v = 0; v < vertex_count_; ++v) {
    for (int d = 0; d < dofs_; ++d) result[dofs_ * v + d] = found[dofs_ * rank_[v] + d];
  }
  return result;
}

}  // namespace partuv
