#pragma once

#include <cstdint>

namespace partuv::packing {

/// Sums are added up this many at a time. What lies behind them, up to the next multiple, is read
/// and written, too, and means nothing.
constexpr int lane_count = 16;

/// Where the sums at both ends of a run lie for the first position.
struct Strip {
  const uint32_t* begin;
  const uint32_t* end;
};

/// to[x] += the sums over all strips, moved by `ahead` + x, for x in [0, count); `anew` begins with
/// zeros. Returns the least of them.
uint32_t add_strips(uint32_t* to, const Strip* strips, int strip_count, int ahead, int count,
                    bool anew);

/// Changes of weight from cell to cell become sums of the weights of all cells before each.
void sum_twice(uint32_t* line, int count);

/// The same for as many rows as `stride` says, a multiple of `lane_count`: they lie side by side,
/// cell after cell.
void sum_rows_twice(uint32_t* first, int count, int stride);

}  // namespace partuv::packing
