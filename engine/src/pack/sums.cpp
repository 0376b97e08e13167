#include "pack/sums.hpp"

#include <algorithm>

#include "wide.hpp"

namespace partuv::packing {

namespace {

using Lanes = uint32_t __attribute__((vector_size(32), aligned(4), may_alias));
constexpr int lane_width = 8;
static_assert(lane_count == 2 * lane_width);

}  // namespace

PARTUV_WIDE uint32_t add_strips(uint32_t* to, const Strip* strips, int strip_count, int ahead,
                                int count, bool anew) {
  Lanes lowest = ~Lanes{};
  uint32_t result = ~uint32_t{0};
  for (int x = 0; x < count; x += lane_count) {
    auto* low = reinterpret_cast<Lanes*>(to + x);
    auto* high = reinterpret_cast<Lanes*>(to + x + lane_width);
    Lanes low_sum{}, high_sum{};
    if (!anew) {
      low_sum = *low;
      high_sum = *high;
    }
    for (int i = 0; i < strip_count; ++i) {
      const uint32_t* begin = strips[i].begin + ahead + x;
      const uint32_t* end = strips[i].end + ahead + x;
      low_sum += *reinterpret_cast<const Lanes*>(end);
      low_sum -= *reinterpret_cast<const Lanes*>(begin);
      high_sum += *reinterpret_cast<const Lanes*>(end + lane_width);
      high_sum -= *reinterpret_cast<const Lanes*>(begin + lane_width);
    }
    *low = low_sum;
    *high = high_sum;
    if (x + lane_count <= count) {
      low_sum = low_sum < high_sum ? low_sum : high_sum;
      lowest = low_sum < lowest ? low_sum : lowest;
    } else {
      for (int rest = x; rest < count; ++rest) result = std::min(result, to[rest]);
    }
  }
  for (int k = 0; k < lane_width; ++k) result = std::min<uint32_t>(result, lowest[k]);
  return result;
}

void sum_twice(uint32_t* line, int count) {
  uint32_t weight = 0;
  uint32_t sum = 0;
  for (int x = 0; x < count; ++x) {
    weight += line[x];
    line[x] = sum;
    sum += weight;
  }
}

PARTUV_WIDE void sum_rows_twice(uint32_t* first, int count, int stride) {
  for (int row = 0; row < stride; row += lane_count) {
    Lanes low_weight{}, low_sum{}, high_weight{}, high_sum{};
    uint32_t* at = first + row;
    for (int x = 0; x < count; ++x, at += stride) {
      auto* low = reinterpret_cast<Lanes*>(at);
      auto* high = reinterpret_cast<Lanes*>(at + lane_width);
      low_weight += *low;
      high_weight += *high;
      *low = low_sum;
      *high = high_sum;
      low_sum += low_weight;
      high_sum += high_weight;
    }
  }
}

}  // namespace partuv::packing
