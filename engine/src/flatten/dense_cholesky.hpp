#pragma once

namespace partuv {

/// Cholesky factorisation, in place, of the first `columns` columns of a symmetric matrix of
/// `height` rows, whose lower half is given by columns. False at a pivot that is not positive.
bool factor_columns(double* panel, int height, int columns);

/// Lower half of update -= b b^T, where b are the last `size` rows of `columns` columns that lie
/// `height` apart; update is size x size by columns.
void subtract_square(double* update, int size, const double* b, int height, int columns);

}  // namespace partuv
