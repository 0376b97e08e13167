#include "pack/swap.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "pack/greedy.hpp"
#include "pack/orient.hpp"
#include "pack/polish.hpp"
#include "pack/separate.hpp"

namespace partuv::packing {

namespace {

using Pair = std::pair<int, int>;

class Swapper {
 public:
  Swapper(const std::vector<Outline>& charts, const std::vector<std::vector<int>>& groups,
          const Bin& bin, double target, const Context& context)
      : charts_(charts),
        groups_(groups),
        bin_(bin),
        target_(target),
        context_(context),
        polisher_(charts, bin, target, false),
        group_(charts.size()) {
    const double cell = (bin.side + bin.gutter) / cells;
    shapes_ = make_shapes(charts, 0.1 * cell / target, bin.gutter / target, false);
    for (size_t g = 0; g < groups.size(); ++g) {
      for (const int chart : groups[g]) group_[chart] = static_cast<int>(g);
    }
  }

  /// The most promising pair first; after a success all others may be promising again.
  void run(int attempts, Layout& layout) {
    std::set<Pair> tried;
    for (; attempts > 0 && !context_.stopping(); --attempts) {
      const Pair pair = best_pair(layout, tried);
      if (pair.first < 0) break;
      tried.insert(pair);
      Layout swapped = swap(pair, layout, static_cast<uint64_t>(attempts));
      if (swapped.scale < target_ || spread(swapped) >= worth * spread(layout)) continue;
      layout = std::move(swapped);
      tried.clear();
    }
    close_up(layout);
  }

 private:
  static constexpr int cells = 256;
  static constexpr double worth = 0.995;  // of the spread: what is worth a swap
  static constexpr double alike = 8.0;    // areas of charts that may take each other's place
  static constexpr double looser = 0.98;  // of the scale: where charts come apart again
  static constexpr int64_t work_per_chart = 1'000'000;

  const std::vector<Outline>& charts_;
  const std::vector<std::vector<int>>& groups_;
  const Bin& bin_;
  double target_;
  const Context& context_;
  Polisher polisher_;
  std::vector<Shape> shapes_;
  std::vector<int> group_;  // of each chart

  void close_up(Layout& layout) const {
    constexpr int steps = 40;
    Layout tight = layout;
    polisher_.tighten(tight, steps, Caught::fail, context_);
    polisher_.settle(tight, context_);
    if (tight.scale > layout.scale) layout = std::move(tight);
    polisher_.close_up(layout, context_);
  }

  /// Distances of a group's charts to their middle, in texels, all together.
  double spread_of_group(int group, const Layout& layout) const {
    Vec2 middle = Vec2::Zero();
    for (const int chart : groups_[group]) middle += layout.poses[chart].centre;
    middle /= static_cast<double>(groups_[group].size());
    double sum = 0.0;
    for (const int chart : groups_[group]) sum += (layout.poses[chart].centre - middle).norm();
    return sum;
  }

  double spread(const Layout& layout) const {
    double sum = 0.0;
    for (size_t g = 0; g < groups_.size(); ++g) {
      sum += spread_of_group(static_cast<int>(g), layout);
    }
    return sum;
  }

  /// The charts of different groups whose swap would lessen the spread most.
  Pair best_pair(Layout layout, const std::set<Pair>& tried) const {
    Pair best{-1, -1};
    double most = (1.0 - worth) * spread(layout);
    for (int one = 0; one < static_cast<int>(charts_.size()); ++one) {
      for (int two = 0; two < one; ++two) {
        const double a = charts_[one].area;
        const double b = charts_[two].area;
        if (group_[one] == group_[two] || a > alike * b || b > alike * a) continue;
        if (tried.contains({one, two})) continue;
        auto both = [&] {
          return spread_of_group(group_[one], layout) + spread_of_group(group_[two], layout);
        };
        const double before = both();
        std::swap(layout.poses[one].centre, layout.poses[two].centre);
        const double gain = before - both();
        std::swap(layout.poses[one].centre, layout.poses[two].centre);
        if (gain <= most) continue;
        most = gain;
        best = {one, two};
      }
    }
    return best;
  }

  /// The layout with two charts in each other's place, and others moved where that takes it. Scale
  /// 0 when they do not come apart.
  Layout swap(const Pair& pair, Layout layout, uint64_t seed) const {
    const auto [one, two] = pair;
    std::swap(layout.poses[one], layout.poses[two]);
    // The longer sides lie as those of the chart that was there.
    const double turn = shapes_[one].start_rad - shapes_[two].start_rad;
    layout.poses[one].rotation_rad += turn;
    layout.poses[two].rotation_rad -= turn;
    layout.scale = looser * target_;
    SeparationPlan plan;
    plan.cells = cells;
    plan.rotations = 16;
    plan.work = work_per_chart * static_cast<int64_t>(charts_.size());
    plan.seed = seed;
    Layout apart = separate(shapes_, bin_, layout, plan, context_).layout;
    if (apart.scale <= 0.0) return apart;
    constexpr int steps = 12;
    polisher_.tighten(apart, steps, Caught::fail, context_);
    polisher_.settle(apart, context_);
    return apart;
  }
};

}  // namespace

void swap_together(const std::vector<Outline>& charts, const std::vector<std::vector<int>>& groups,
                   const Bin& bin, double target, double effort, Layout& layout,
                   const Context& context) {
  constexpr double attempts = 40.0;  // at effort 1, of at most 1e6
  const int most = static_cast<int>(std::ceil(effort * attempts));
  Swapper(charts, groups, bin, target, context).run(most, layout);
}

}  // namespace partuv::packing
