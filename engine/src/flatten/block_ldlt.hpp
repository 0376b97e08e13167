#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"

namespace partuv {

/// LDL^T factorisation of a symmetric positive definite matrix of D x D blocks, row by row along
/// the elimination tree (Davis 2005, "a concise sparse Cholesky"). On the systems of a mesh, whose
/// unknowns come in pairs, blocks save three quarters of the index work of a scalar factorisation.
template <int D>
class BlockLdlt {
 public:
  /// Row i's neighbours before it, ascending: before[start[i]] .. before[start[i + 1] - 1].
  void analyse(int rows, const std::vector<int32_t>& start, const std::vector<int32_t>& before);

  /// diagonal: rows blocks; lower: one block A(i, before[p]) per neighbour, row-major. False if a
  /// pivot is not positive, or the context is cancelled on the way.
  bool factor(const std::vector<double>& diagonal, const std::vector<double>& lower,
              const Context& context);

  /// Solve in place, rows x D values.
  void solve(double* x) const;

 private:
  int rows_ = 0;
  std::vector<int32_t> start_, before_;
  std::vector<int32_t> parent_;          ///< elimination tree
  std::vector<int64_t> column_start_;    ///< per column of L
  std::vector<int32_t> row_of_;          ///< per block of L
  std::vector<double> value_;            ///< blocks of L, row-major, by column
  std::vector<double> pivot_, inverse_;  ///< diagonal blocks and their inverses
};

extern template class BlockLdlt<1>;
extern template class BlockLdlt<2>;

}  // namespace partuv
