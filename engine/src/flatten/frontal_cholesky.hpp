#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flatten/supernodes.hpp"
#include "partuv/context.hpp"

namespace partuv {

/// Multifrontal Cholesky factorisation (Duff, Reid 1983; Liu 1992) of a symmetric positive definite
/// matrix of D x D blocks: a dense front per supernode, so that nearly all of the work is products
/// of dense matrices. Branches of the tree are eliminated side by side where the context has
/// threads to spare; the result does not depend on it.
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
  /// Consecutive supernodes with all that is below them in the tree.
  struct Branch {
    int32_t first, end;
    int64_t stack;  ///< where its updates lie
  };

  int height(int s) const { return D * (tree_.columns(s) + tree_.below(s)); }
  int64_t update_size(int s) const;
  void find_branches();
  void lay_out_stack();

  /// Updates that wait for their parents, one above the other.
  struct Waiting {
    std::vector<int32_t> supernodes;
    int64_t top;
  };
  /// Assemble and factor the front of s. Its update takes the place of those of its children, which
  /// are the last that wait, and of `others`, which lie elsewhere.
  bool eliminate(int s, const std::vector<double>& diagonal, const std::vector<double>& lower,
                 std::span<const int32_t> others, Waiting& waiting, const Context& context);
  void assemble_entries(int s, const std::vector<double>& diagonal,
                        const std::vector<double>& lower);
  void assemble_child(int child, int parent, double* parent_update);

  Supernodes tree_;
  std::vector<Branch> branches_;  ///< can be eliminated side by side, before the others
  std::vector<int32_t> trunk_;    ///< supernodes in no branch
  std::vector<int32_t>
      handed_;               ///< children of the trunk in branches, in the order of their parents
  int64_t trunk_stack_ = 0;  ///< where the updates of the trunk lie
  std::vector<int64_t> panel_start_;  ///< per supernode, into panel_
  std::vector<double> panel_;         ///< the factor: own columns of each front, by columns
  std::vector<int64_t> update_at_;    ///< per supernode, into stack_
  std::vector<double> stack_;
};

extern template class FrontalCholesky<1>;
extern template class FrontalCholesky<2>;

}  // namespace partuv
