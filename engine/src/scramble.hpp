#pragma once

#include <cstdint>

namespace partuv {

/// SplitMix64 (Steele, Lea, Flood 2014): well mixed bits, the same on every platform.
inline uint64_t scramble(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace partuv
