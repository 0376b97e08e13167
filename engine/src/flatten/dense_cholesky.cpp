#include "flatten/dense_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "wide.hpp"

namespace partuv {
namespace {

constexpr int lanes = 4;
using Lanes
    [[gnu::vector_size(lanes * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] =
        double;

PARTUV_INLINE const Lanes& lanes_at(const double* p) { return *reinterpret_cast<const Lanes*>(p); }
PARTUV_INLINE Lanes& lanes_at(double* p) { return *reinterpret_cast<Lanes*>(p); }

/// target -= a b^T for a tile of 4 Rows x Columns; everything by columns, those of a and b lie
/// `height` apart, those of the target `stride`.
template <int Rows, int Columns>
PARTUV_INLINE void subtract_tile(double* target, int64_t stride, const double* a, const double* b,
                                 int64_t height, int depth) {
  Lanes sum[Columns][Rows] = {};
  for (int j = 0; j < depth; ++j, a += height, b += height) {
    for (int c = 0; c < Columns; ++c) {
      for (int r = 0; r < Rows; ++r) sum[c][r] += lanes_at(a + lanes * r) * b[c];
    }
  }
  for (int c = 0; c < Columns; ++c) {
    for (int r = 0; r < Rows; ++r) lanes_at(target + c * stride + lanes * r) -= sum[c][r];
  }
}

/// The same for a single row of the tile.
template <int Columns>
PARTUV_INLINE void subtract_row(double* target, int64_t stride, const double* a, const double* b,
                                int64_t height, int depth) {
  double sum[Columns] = {};
  for (int j = 0; j < depth; ++j, a += height, b += height) {
    for (int c = 0; c < Columns; ++c) sum[c] += *a * b[c];
  }
  for (int c = 0; c < Columns; ++c) target[c * stride] -= sum[c];
}

template <int Columns>
PARTUV_INLINE void subtract_strip(double* target, int64_t stride, int rows, const double* a,
                                  const double* b, int64_t height, int depth) {
  int r = 0;
  for (; r + 2 * lanes <= rows; r += 2 * lanes) {
    subtract_tile<2, Columns>(target + r, stride, a + r, b, height, depth);
  }
  if (r + lanes <= rows) {
    subtract_tile<1, Columns>(target + r, stride, a + r, b, height, depth);
    r += lanes;
  }
  for (; r < rows; ++r) subtract_row<Columns>(target + r, stride, a + r, b, height, depth);
}

/// Rows from the diagonal on of the columns [from, to) of target -= b b^T. Works in blocks that
/// stay in the cache; four rows above the diagonal may be written.
PARTUV_WIDE void subtract_columns(double* target, int64_t stride, int rows, const double* b,
                                  int64_t height, int depth, int from, int to) {
  constexpr int deep = 64, high = 64;
  for (int j = 0; j < depth; j += deep) {
    const double* const block = b + j * height;
    const int part = std::min(deep, depth - j);
    for (int start = from; start < rows; start += high) {
      const int end = std::min(start + high, rows);
      int c = from;
      for (; c + 4 <= std::min(to, end); c += 4) {
        const int r = std::max(start, c);
        subtract_strip<4>(target + c * stride + r, stride, end - r, block + r, block + c, height,
                          part);
      }
      for (; c < std::min(to, end); ++c) {
        const int r = std::max(start, c);
        subtract_strip<1>(target + c * stride + r, stride, end - r, block + r, block + c, height,
                          part);
      }
    }
  }
}

/// Rows from the diagonal on of the first `columns` columns of target -= b b^T; side by side where
/// that pays.
void subtract_lower(double* target, int64_t stride, int rows, int columns, const double* b,
                    int64_t height, int depth, const Context& context) {
  constexpr int wide = 32;
  constexpr int64_t worth_a_thread = 1'000'000;  // multiplications
  if (static_cast<int64_t>(rows) * columns * depth < 2 * worth_a_thread) {
    subtract_columns(target, stride, rows, b, height, depth, 0, columns);
    return;
  }
  parallel_for(context, (columns + wide - 1) / wide, [&](int i) {
    subtract_columns(target, stride, rows, b, height, depth, i * wide,
                     std::min((i + 1) * wide, columns));
  });
}

/// Factor few columns, one after the other.
PARTUV_WIDE bool factor_block(double* block, int64_t height, int rows, int columns) {
  for (int j = 0; j < columns; ++j) {
    double* const own = block + j * height;
    subtract_strip<1>(own + j, height, rows - j, block + j, block + j, height, j);
    if (!(own[j] > 0.0)) return false;
    const double root = std::sqrt(own[j]), inverse = 1.0 / root;
    own[j] = root;
    for (int i = j + 1; i < rows; ++i) own[i] *= inverse;
  }
  return true;
}

}  // namespace

bool factor_columns(double* panel, int height, int columns, const Context& context) {
  constexpr int wide = 16;
  for (int from = 0; from < columns; from += wide) {
    const int end = std::min(from + wide, columns);
    double* const corner = panel + static_cast<int64_t>(from) * height + from;
    if (!factor_block(corner, height, height - from, end - from)) return false;
    if (end == columns) break;
    subtract_lower(panel + static_cast<int64_t>(end) * height + end, height, height - end,
                   columns - end, corner + (end - from), height, end - from, context);
  }
  return true;
}

void subtract_square(double* update, int size, const double* b, int height, int columns,
                     const Context& context) {
  subtract_lower(update, size, size, size, b, height, columns, context);
}

PARTUV_WIDE void solve_forward(const double* panel, int height, int columns, double* x,
                               double* below) {
  const int size = height - columns;
  std::fill_n(below, size, 0.0);
  for (int j = 0; j < columns; ++j) {
    const double* const column = panel + static_cast<int64_t>(j) * height;
    const double value = x[j] /= column[j];
    for (int i = j + 1; i < columns; ++i) x[i] -= column[i] * value;
    const double* const rest = column + columns;
    for (int i = 0; i < size; ++i) below[i] += rest[i] * value;
  }
}

PARTUV_WIDE void solve_backward(const double* panel, int height, int columns, double* x,
                                const double* below) {
  const int size = height - columns;
  for (int j = columns - 1; j >= 0; --j) {
    const double* const column = panel + static_cast<int64_t>(j) * height;
    const double* const rest = column + columns;
    Lanes sums = {};
    int i = 0;
    for (; i + lanes <= size; i += lanes) sums += lanes_at(rest + i) * lanes_at(below + i);
    double sum = x[j] - ((sums[0] + sums[1]) + (sums[2] + sums[3]));
    for (; i < size; ++i) sum -= rest[i] * below[i];
    for (int k = j + 1; k < columns; ++k) sum -= column[k] * x[k];
    x[j] = sum / column[j];
  }
}

}  // namespace partuv
