#include "flatten/block_ldlt.hpp"

#include <algorithm>

namespace partuv {
namespace {

template <int D>
bool invert(const double* a, double* inverse) {
  if constexpr (D == 1) {
    if (!(a[0] > 0.0)) return false;
    inverse[0] = 1.0 / a[0];
  } else {
    const double det = a[0] * a[3] - a[1] * a[2];
    if (!(a[0] > 0.0 && det > 0.0)) return false;
    inverse[0] = a[3] / det;
    inverse[1] = -a[1] / det;
    inverse[2] = -a[2] / det;
    inverse[3] = a[0] / det;
  }
  return true;
}

}  // namespace

template <int D>
void BlockLdlt<D>::analyse(int rows, const std::vector<int32_t>& start,
                           const std::vector<int32_t>& before) {
  rows_ = rows;
  start_ = start;
  before_ = before;
  parent_.assign(rows, -1);
  std::vector<int32_t> mark(rows, -1);
  std::vector<int64_t> count(rows, 0);
  for (int k = 0; k < rows; ++k) {
    mark[k] = k;
    for (int p = start_[k]; p < start_[k + 1]; ++p) {
      for (int i = before_[p]; mark[i] != k; i = parent_[i]) {
        if (parent_[i] < 0) parent_[i] = k;
        ++count[i];
        mark[i] = k;
      }
    }
  }
  column_start_.assign(rows + 1, 0);
  for (int k = 0; k < rows; ++k) column_start_[k + 1] = column_start_[k] + count[k];
  row_of_.resize(column_start_.back());
  value_.resize(column_start_.back() * D * D);
  pivot_.resize(static_cast<size_t>(rows) * D * D);
  inverse_.resize(pivot_.size());
}

template <int D>
bool BlockLdlt<D>::factor(const std::vector<double>& diagonal, const std::vector<double>& lower,
                          const Context& context) {
  constexpr int B = D * D;
  std::vector<int64_t> filled(column_start_.begin(), column_start_.end() - 1);
  std::vector<double> y(static_cast<size_t>(rows_) * B, 0.0);
  std::vector<int32_t> mark(rows_, -1), reach(rows_), path(rows_);
  for (int k = 0; k < rows_; ++k) {
    if (k % 512 == 0 && context.cancelled()) return false;
    // Columns with an entry in row k, in an order in which each comes before its ancestors.
    int top = rows_;
    mark[k] = k;
    for (int p = start_[k]; p < start_[k + 1]; ++p) {
      int i = before_[p];
      // Block (i, k) of the upper half is the transpose of (k, i).
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c)
          y[static_cast<size_t>(i) * B + r * D + c] = lower[p * B + c * D + r];
      }
      int length = 0;
      for (; mark[i] != k; i = parent_[i]) {
        path[length++] = i;
        mark[i] = k;
      }
      while (length > 0) reach[--top] = path[--length];
    }
    double pivot[B];
    std::copy_n(&diagonal[static_cast<size_t>(k) * B], B, pivot);
    for (; top < rows_; ++top) {
      const int i = reach[top];
      double yi[B];
      double* at = &y[static_cast<size_t>(i) * B];
      for (int b = 0; b < B; ++b) {
        yi[b] = at[b];
        at[b] = 0.0;
      }
      const int64_t end = filled[i];
      for (int64_t p = column_start_[i]; p < end; ++p) {
        const double* l = &value_[p * B];
        double* target = &y[static_cast<size_t>(row_of_[p]) * B];
        for (int r = 0; r < D; ++r) {
          for (int c = 0; c < D; ++c) {
            for (int m = 0; m < D; ++m) target[r * D + c] -= l[r * D + m] * yi[m * D + c];
          }
        }
      }
      // L(k, i) = y' D^-1, and its share of the pivot.
      double* l = &value_[end * B];
      const double* inverse = &inverse_[static_cast<size_t>(i) * B];
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) {
          double sum = 0.0;
          for (int m = 0; m < D; ++m) sum += yi[m * D + r] * inverse[m * D + c];
          l[r * D + c] = sum;
        }
      }
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) {
          for (int m = 0; m < D; ++m) pivot[r * D + c] -= l[r * D + m] * yi[m * D + c];
        }
      }
      row_of_[end] = k;
      ++filled[i];
    }
    std::copy_n(pivot, B, &pivot_[static_cast<size_t>(k) * B]);
    if (!invert<D>(pivot, &inverse_[static_cast<size_t>(k) * B])) return false;
  }
  return true;
}

template <int D>
void BlockLdlt<D>::solve(double* x) const {
  constexpr int B = D * D;
  for (int k = 0; k < rows_; ++k) {
    const double* xk = x + static_cast<size_t>(k) * D;
    for (int64_t p = column_start_[k]; p < column_start_[k + 1]; ++p) {
      double* target = x + static_cast<size_t>(row_of_[p]) * D;
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) target[r] -= value_[p * B + r * D + c] * xk[c];
      }
    }
  }
  for (int k = 0; k < rows_; ++k) {
    double scaled[D];
    double* xk = x + static_cast<size_t>(k) * D;
    for (int r = 0; r < D; ++r) {
      scaled[r] = 0.0;
      for (int c = 0; c < D; ++c)
        scaled[r] += inverse_[static_cast<size_t>(k) * B + r * D + c] * xk[c];
    }
    std::copy_n(scaled, D, xk);
  }
  for (int k = rows_ - 1; k >= 0; --k) {
    double* xk = x + static_cast<size_t>(k) * D;
    for (int64_t p = column_start_[k]; p < column_start_[k + 1]; ++p) {
      const double* source = x + static_cast<size_t>(row_of_[p]) * D;
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) xk[c] -= value_[p * B + r * D + c] * source[r];
      }
    }
  }
}

template class BlockLdlt<1>;
template class BlockLdlt<2>;

}  // namespace partuv
