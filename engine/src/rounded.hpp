#pragma once

#include <bit>
#include <cstdint>

namespace partuv {

/// A score to about four digits. Scores that are equal by symmetry, or on even ground, then stay
/// equal however the mesh is turned, and numbers decide. Keeps the order of scores.
inline float rounded(double score) {
  constexpr uint32_t dropped_bits = 11;
  const uint32_t bits = std::bit_cast<uint32_t>(static_cast<float>(score));
  return std::bit_cast<float>((bits + (1u << (dropped_bits - 1))) >> dropped_bits << dropped_bits);
}

}  // namespace partuv
