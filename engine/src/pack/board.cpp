#include "pack/board.hpp"

#include <algorithm>
#include <bit>

namespace partuv::packing {

namespace {

/// to[i] |= from >> shift, for the first `count` words; `from` has words behind them to shift in.
inline void or_shifted(uint64_t* to, const uint64_t* from, int shift, int count) {
  const uint64_t* source = from + shift / 64;
  const int bits = shift % 64;
  if (bits == 0) {
    for (int i = 0; i < count; ++i) to[i] |= source[i];
  } else {
    for (int i = 0; i < count; ++i) {
      to[i] |= (source[i] >> bits) | (source[i + 1] << (64 - bits));
    }
  }
}

}  // namespace

Board::Board(int side, int width)
    : side_(side),
      width_(width),
      words_(width / 64 + 2),
      levels_(std::bit_width(static_cast<unsigned>(width))),
      taken_(size_t(side) * levels_ * words_),
      longest_free_(side),
      collision_(words_) {
  clear();
}

void Board::clear() {
  for (int row = 0; row < side_; ++row) {
    uint64_t* cells = level(row, 0);
    std::fill(cells, cells + words_, 0);
    for (int x = width_; x < 64 * words_; ++x) cells[x / 64] |= uint64_t{1} << (x % 64);
    refresh(row);
  }
  filled_height_ = 0;
}

void Board::refresh(int row) {
  for (int k = 1; k < levels_; ++k) {
    const uint64_t* finer = level(row, k - 1);
    uint64_t* coarser = level(row, k);
    const int step = 1 << (k - 1);
    std::copy(finer, finer + words_, coarser);
    // Behind the last word everything is taken.
    for (int i = 0; i < words_; ++i) {
      const int from = i + step / 64;
      const uint64_t low = from < words_ ? finer[from] : ~uint64_t{0};
      const uint64_t high = from + 1 < words_ ? finer[from + 1] : ~uint64_t{0};
      const int bits = step % 64;
      coarser[i] |= bits ? (low >> bits) | (high << (64 - bits)) : low;
    }
  }
  const uint64_t* cells = level(row, 0);
  int longest = 0;
  int start = 0;
  for (int x = 0; x <= width_;) {
    // Jump from the end of one taken stretch to the next one.
    uint64_t word = cells[x / 64] >> (x % 64);
    if (word == 0) {
      x = (x / 64 + 1) * 64;
      continue;
    }
    x += std::countr_zero(word);
    longest = std::max(longest, std::min(x, width_) - start);
    if (x >= width_) break;
    while (x < width_) {
      word = ~(cells[x / 64] >> (x % 64));
      const int left_in_word = 64 - x % 64;
      const int ones = std::min(word == 0 ? 64 : std::countr_zero(word), left_in_word);
      x += ones;
      if (ones < left_in_word) break;
    }
    start = x;
  }
  longest_free_[row] = longest;
}

Board::Spot Board::lowest(const Mask& mask, int from, int to) {
  Spot spot;
  const int columns = width_ - mask.width + 1;
  to = std::min(to, side_ - mask.height + 1);
  if (columns <= 0) return spot;
  const int count = (columns + 63) / 64;
  const uint64_t beyond = columns % 64 ? ~uint64_t{0} << (columns % 64) : 0;
  for (int y = from; y < to; ++y) {
    if (y >= filled_height_) return {0, y, true};
    std::fill(collision_.begin(), collision_.begin() + count, 0);
    bool full = false;
    for (int row : mask.test_order) {
      if (y + row >= filled_height_) continue;
      const int free = longest_free_[y + row];
      if (free == width_) continue;
      for (int i = mask.row_start[row]; i < mask.row_start[row + 1] && !full; ++i) {
        const Run run = mask.runs[i];
        const int length = run.end - run.begin;
        if (length > free) {
          full = true;
          break;
        }
        const int k = std::bit_width(static_cast<unsigned>(length)) - 1;
        const uint64_t* cells = level(y + row, k);
        or_shifted(collision_.data(), cells, run.begin, count);
        if (length != 1 << k) or_shifted(collision_.data(), cells, run.end - (1 << k), count);
      }
      if (full) break;
      uint64_t all = ~uint64_t{0};
      for (int i = 0; i + 1 < count; ++i) all &= collision_[i];
      full = (all & (collision_[count - 1] | beyond)) == ~uint64_t{0};
      if (full) break;
    }
    if (full) continue;
    for (int i = 0; i < count; ++i) {
      const uint64_t open = ~(collision_[i] | (i + 1 == count ? beyond : 0));
      if (open) return {64 * i + std::countr_zero(open), y, true};
    }
  }
  return spot;
}

void Board::put(const Mask& mask, int x, int y) {
  for (int row = std::max(0, -y); row < mask.height && y + row < side_; ++row) {
    uint64_t* cells = level(y + row, 0);
    for (int i = mask.row_start[row]; i < mask.row_start[row + 1]; ++i) {
      int begin = std::max(0, x + mask.runs[i].begin);
      const int end = std::min(width_, x + mask.runs[i].end);
      while (begin < end) {
        const int stop = std::min(end, (begin / 64 + 1) * 64);
        const int length = stop - begin;
        const uint64_t bits = length == 64 ? ~uint64_t{0} : (uint64_t{1} << length) - 1;
        cells[begin / 64] |= bits << (begin % 64);
        begin = stop;
      }
    }
    refresh(y + row);
  }
  filled_height_ = std::clamp(y + mask.height, filled_height_, side_);
}

}  // namespace partuv::packing
