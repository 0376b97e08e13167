#pragma once

#include <cstdint>

#include "scramble.hpp"

namespace partuv::packing {

/// A number in [0, 1) for a place in a sequence.
inline double uniform(uint64_t seed, uint64_t index) {
  return static_cast<double>(scramble(scramble(seed) + index) >> 11) * 0x1p-53;
}

/// A stream of such numbers.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(scramble(seed)) {}
  uint64_t next() { return scramble(state_++); }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  int below(int count) { return static_cast<int>(next() % static_cast<uint64_t>(count)); }

 private:
  uint64_t state_;
};

}  // namespace partuv::packing
