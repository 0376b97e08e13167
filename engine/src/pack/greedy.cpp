#include "pack/greedy.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "pack/board.hpp"
#include "pack/mask.hpp"
#include "pack/orient.hpp"

namespace partuv::packing {

namespace {

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every platform.
uint64_t scramble(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

double uniform(uint64_t seed, uint64_t index) {
  return static_cast<double>(scramble(scramble(seed) + index) >> 11) * 0x1p-53;
}

std::vector<int> falling_size(const std::vector<Outline>& charts, uint64_t variant) {
  std::vector<double> size(charts.size());
  for (size_t i = 0; i < charts.size(); ++i) {
    // Bulky and long charts both want room early: the mean of area and squared radius.
    size[i] = std::sqrt(charts[i].area + charts[i].radius * charts[i].radius);
    if (variant) size[i] *= std::exp(0.5 * (uniform(variant, i) - 0.5));
  }
  std::vector<int> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size[a] > size[b]; });
  return order;
}

/// The lowest row where charts of about a size last found room. Room only shrinks and the charts
/// come by falling size, so looking further down again would be in vain, nearly always.
class Floors {
 public:
  explicit Floors(size_t charts) : enabled_(charts > few) {}
  int get(const Mask& mask) const {
    const auto found = floors_.find(key(mask));
    return found == floors_.end() ? 0 : found->second;
  }
  void set(const Mask& mask, int y) {
    if (enabled_) floors_[key(mask)] = y;
  }

 private:
  static constexpr size_t few = 400;
  bool enabled_;
  std::map<std::pair<int, int>, int> floors_;
  static int step(int size) { return static_cast<int>(std::floor(8.0 * std::log2(size))); }
  static std::pair<int, int> key(const Mask& mask) { return {step(mask.width), step(mask.height)}; }
};

}  // namespace

Layout greedy(const std::vector<Outline>& charts, const Bin& bin, double scale,
              const GreedyPlan& plan, const Context& context) {
  Layout layout;
  layout.poses.resize(charts.size());
  const double cell = (bin.side + bin.gutter) / plan.cells;  // texels
  // Growth beyond half the gutter covers rounding in the mask's own arithmetic.
  const double growth = (0.5 * bin.gutter) / cell + 1e-7;
  Board board(plan.cells);
  Floors floors(charts.size());
  for (int index : falling_size(charts, plan.variant)) {
    if (context.stopping()) return layout;
    const Outline& outline = charts[index];
    const double start = least_rectangle(outline.hull).rotation_rad;
    Mask best_mask;
    Board::Spot best;
    int best_top = 0;
    for (int turn = 0; turn < plan.rotations; ++turn) {
      const double angle = start + 2.0 * std::numbers::pi * turn / plan.rotations;
      Mask mask = make_mask(outline, angle, scale / cell, growth);
      const int to = best.found ? best_top - mask.height + 1 : plan.cells;
      const Board::Spot spot = board.lowest(mask, floors.get(mask), to);
      if (!spot.found) continue;
      const int top = spot.y + mask.height;
      if (!best.found || top < best_top || (top == best_top && spot.x < best.x)) {
        best = spot;
        best_top = top;
        best_mask = std::move(mask);
      }
    }
    if (!best.found) return layout;
    board.put(best_mask, best.x, best.y);
    floors.set(best_mask, best.y);
    const Vec2 corner(best.x, best.y);
    layout.poses[index] = {best_mask.rotation_rad,
                           ((corner + best_mask.centre) * cell).array() - 0.5 * bin.gutter};
  }
  layout.scale = scale;
  return layout;
}

}  // namespace partuv::packing
