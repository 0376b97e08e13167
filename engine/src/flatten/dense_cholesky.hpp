#pragma once

#include "partuv/context.hpp"

namespace partuv {

/// Cholesky factorisation, in place, of the first `columns` columns of a symmetric matrix of
/// `height` rows, whose lower half is given by columns. False at a pivot that is not positive.
bool factor_columns(double* panel, int height, int columns, const Context& context);

/// Lower half of update -= b b^T, where b are the last `size` rows of `columns` columns that lie
/// `height` apart; update is size x size by columns. What lies above the diagonal is undefined.
void subtract_square(double* update, int size, const double* b, int height, int columns,
                     const Context& context);

/// Forward substitution with a factored panel: solves for the `columns` values x, and sets
/// below[i] to what they subtract from the right-hand side of the i-th row below.
void solve_forward(const double* panel, int height, int columns, double* x, double* below);

/// Backward substitution: x becomes the solution of the panel's columns, given that of the rows
/// below.
void solve_backward(const double* panel, int height, int columns, double* x, const double* below);

}  // namespace partuv
