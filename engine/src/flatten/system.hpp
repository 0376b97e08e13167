#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "flatten/frontal_cholesky.hpp"
#include "partuv/surface.hpp"

namespace partuv {

/// A symmetric linear system over the vertices of a triangle mesh with D unknowns per vertex and
/// the pattern of its edges. The ordering and the symbolic analysis are made once, on the vertex
/// graph; values are then summed face by face and factored any number of times.
template <int D>
class MeshSystem {
 public:
  /// faces: indices below vertex_count; entries of -1 are left out (fixed vertices).
  MeshSystem(std::vector<Triangle> faces, int vertex_count);

  void clear();
  /// Add a face's symmetric matrix, 3 D x 3 D, vertex-major, given as local(row, column).
  template <typename Local>
  void add(int face, const Local& local);
  void add_diagonal(int vertex, int dof, double value);
  double mean_diagonal() const;
  /// Shift the whole diagonal and factor. False if the matrix is not usable or the context
  /// cancelled.
  bool factor(double shift, const Context& context);
  /// Solve for a right-hand side, D x vertex_count entries, vertex-major.
  Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const;

 private:
  static constexpr int block = D * D;
  std::vector<Triangle> faces_;
  std::vector<int32_t> rank_;                       ///< vertex -> place in the elimination order
  std::vector<std::array<int32_t, 3>> pair_place_;  ///< per face: lower block of pairs 01, 12, 20
  std::vector<double> diagonal_, lower_;
  FrontalCholesky<D> solver_;
};

template <int D>
template <typename Local>
void MeshSystem<D>::add(int face, const Local& local) {
  const Triangle& t = faces_[face];
  for (int i = 0; i < 3; ++i) {
    if (t[i] < 0) continue;
    double* own = &diagonal_[static_cast<size_t>(rank_[t[i]]) * block];
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) own[r * D + c] += local(D * i + r, D * i + c);
    }
    const int j = (i + 1) % 3;
    if (t[j] < 0) continue;
    // The later of the two is the row.
    const bool forward = rank_[t[j]] > rank_[t[i]];
    const int row = forward ? j : i, column = forward ? i : j;
    double* pair = &lower_[static_cast<size_t>(pair_place_[face][i]) * block];
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) pair[r * D + c] += local(D * row + r, D * column + c);
    }
  }
}

extern template class MeshSystem<1>;
extern template class MeshSystem<2>;

}  // namespace partuv
