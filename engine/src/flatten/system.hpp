#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "partuv/surface.hpp"

namespace partuv {

/// A symmetric linear system over the vertices of a triangle mesh with `dofs` unknowns per vertex
/// and the pattern of its edges, plus a diagonal. The ordering and the symbolic analysis are made
/// once, on the vertex graph; values are then summed face by face and factored any number of times.
class MeshSystem {
 public:
  /// faces: indices below vertex_count; entries of -1 are left out (fixed vertices).
  MeshSystem(const std::vector<Triangle>& faces, int vertex_count, int dofs);

  void clear();
  /// Add a face's symmetric matrix, (3 dofs) x (3 dofs), vertex-major; only its lower half is read.
  template <typename Local>
  void add(int face, const Local& local);
  void add_diagonal(int vertex, int dof, double value);
  double mean_diagonal() const;
  /// Shift the whole diagonal and factor. False if the matrix is not usable.
  bool factor(double shift);
  /// Solve for a right-hand side, dofs x vertex_count entries, vertex-major.
  Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const;

 private:
  int dofs_;
  int vertex_count_;
  const std::vector<Triangle> faces_;
  std::vector<int32_t> rank_;  ///< vertex -> place in the elimination order
  std::vector<int32_t> start_;  ///< per rank: first neighbour in `below_`
  std::vector<int32_t> below_;  ///< ranks of later neighbours, ascending, per rank
  std::vector<std::array<int32_t, 3>> pair_place_;  ///< per face: place of pairs 01, 12, 20
  Eigen::SparseMatrix<double> matrix_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      solver_;
};

template <typename Local>
void MeshSystem::add(int face, const Local& local) {
  const Triangle& t = faces_[face];
  double* values = matrix_.valuePtr();
  for (int i = 0; i < 3; ++i) {
    if (t[i] < 0) continue;
    // Diagonal block, lower half.
    const int r = rank_[t[i]];
    for (int c = 0; c < dofs_; ++c) {
      const int column = matrix_.outerIndexPtr()[dofs_ * r + c];
      for (int d = c; d < dofs_; ++d) values[column + d - c] += local(dofs_ * i + d, dofs_ * i + c);
    }
    const int j = (i + 1) % 3;
    if (t[j] < 0) continue;
    // Off-diagonal block: the later rank is the row.
    const bool forward = rank_[t[j]] > rank_[t[i]];
    const int col_vertex = forward ? i : j, row_vertex = forward ? j : i;
    const int rank = rank_[t[col_vertex]];
    const int place = pair_place_[face][i];
    for (int c = 0; c < dofs_; ++c) {
      const int column = matrix_.outerIndexPtr()[dofs_ * rank + c] + (dofs_ - c) + dofs_ * place;
      for (int d = 0; d < dofs_; ++d) {
        const int a = dofs_ * row_vertex + d, b = dofs_ * col_vertex + c;
        values[column + d] += a >= b ? local(a, b) : local(b, a);
      }
    }
  }
}

}  // namespace partuv
