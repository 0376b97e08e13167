#pragma once

#include <cstdint>

namespace partuv::packing {

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every platform.
inline uint64_t scramble(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

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
