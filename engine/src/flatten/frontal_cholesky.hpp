#pragma once

#include <cstdint>
#include <vector>

#include "flatten/supernodes.hpp"
#include "partuv/context.hpp"

namespace partuv {

/// Multifrontal Cholesky factorisation (Duff, Reid 1983; Liu 1992) of a symmetric positive definite
/// matrix of D x D blocks: a dense front per supernode, so that nearly all of the work is products
/// of dense matrices.
template <int D>
class FrontalCholesky {
 public:
  /// The order must be a postorder of the elimination tree.
  void analyse(const LowerPattern& pattern);

  /// diagonal: a block per row; lower: a block per entry of the pattern; both row-major. False if a
  /// pivot is not positive, or the context is cancelled on the way.
  bool factor(const std::vector<double>& diagonal, const std::vector<double>& lower,
              const Context& context);

  /// Solve in place, rows x D values.
  void solve(double* x) const;

 private:
  int height(int s) const { return D * (tree_.columns(s) + tree_.below(s)); }
  void assemble_entries(int s, const std::vector<double>& diagonal,
                        const std::vector<double>& lower);
  void assemble_child(int child, const double* update, int parent, double* parent_update);

  Supernodes tree_;
  std::vector<int64_t> panel_start_;  ///< per supernode, into panel_
  std::vector<double> panel_;         ///< the factor: own columns of each front, by columns
  std::vector<double> stack_;         ///< updates that wait for their parents
};

extern template class FrontalCholesky<1>;
extern template class FrontalCholesky<2>;

}  // namespace partuv
