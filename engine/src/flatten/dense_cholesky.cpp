#include "flatten/dense_cholesky.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace partuv {
namespace {

using Panel = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ConstPanel = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// target[0 .. n) -= the sum of four columns times their factors.
void subtract_four(double* __restrict target, const double* __restrict b, int height, int n,
                   const double* factor) {
  const double *b0 = b, *b1 = b + height, *b2 = b1 + height, *b3 = b2 + height;
  const double f0 = factor[0], f1 = factor[1], f2 = factor[2], f3 = factor[3];
  for (int i = 0; i < n; ++i) {
    target[i] -= (b0[i] * f0 + b1[i] * f1) + (b2[i] * f2 + b3[i] * f3);
  }
}

void subtract_one(double* __restrict target, const double* __restrict b, int n, double factor) {
  for (int i = 0; i < n; ++i) target[i] -= b[i] * factor;
}

/// target[i] -= sum over columns of b(row + i, .) b(row, .).
void subtract_column(double* target, const double* b, int height, int columns, int n) {
  int j = 0;
  for (; j + 4 <= columns; j += 4) {
    const double* from = b + static_cast<int64_t>(j) * height;
    const double factor[4] = {from[0], from[height], from[2 * height], from[3 * height]};
    subtract_four(target, from, height, n, factor);
  }
  for (; j < columns; ++j) {
    const double* from = b + static_cast<int64_t>(j) * height;
    subtract_one(target, from, n, from[0]);
  }
}

}  // namespace

bool factor_columns(double* panel, int height, int columns) {
  constexpr int wide = 32;
  for (int from = 0; from < columns; from += wide) {
    const int end = std::min(from + wide, columns);
    double* const block = panel + static_cast<int64_t>(from) * height;
    for (int j = from; j < end; ++j) {
      double* const own = panel + static_cast<int64_t>(j) * height;
      subtract_column(own + j, block + j, height, j - from, height - j);
      if (!(own[j] > 0.0)) return false;
      const double root = std::sqrt(own[j]), inverse = 1.0 / root;
      own[j] = root;
      for (int i = j + 1; i < height; ++i) own[i] *= inverse;
    }
    if (end == columns) break;
    // The columns after this block, rows from their diagonal on.
    const int rest = columns - end, rows = height - end;
    const ConstPanel b(block + end, rows, end - from, Eigen::OuterStride<>(height));
    Panel target(panel + static_cast<int64_t>(end) * height + end, rows, rest,
                 Eigen::OuterStride<>(height));
    target.topRows(rest).selfadjointView<Eigen::Lower>().rankUpdate(b.topRows(rest), -1.0);
    target.bottomRows(rows - rest).noalias() -=
        b.bottomRows(rows - rest) * b.topRows(rest).transpose();
  }
  return true;
}

void subtract_square(double* update, int size, const double* b, int height, int columns) {
  // Blocked products pay where there is something to reuse.
  constexpr int large = 48;
  if (size >= large && columns >= 8) {
    Panel target(update, size, size, Eigen::OuterStride<>(size));
    const ConstPanel rows(b, size, columns, Eigen::OuterStride<>(height));
    target.selfadjointView<Eigen::Lower>().rankUpdate(rows, -1.0);
    return;
  }
  for (int c = 0; c < size; ++c) {
    subtract_column(update + static_cast<int64_t>(c) * size + c, b + c, height, columns, size - c);
  }
}

}  // namespace partuv
