#include "pack/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "pack/greedy.hpp"
#include "pack/orient.hpp"
#include "pack/random.hpp"
#include "pack/separate.hpp"

namespace partuv::packing {

namespace {

struct Lane {
  Layout best;
  std::vector<int> caught;  ///< when its last layout was tightened
  double growth = 0.02;     ///< how much larger the scale of the next separation is
  int64_t work = 0;         ///< done in it, in sums
  int failures = 0;         ///< since its best layout
};

class Search {
 public:
  Search(const std::vector<Outline>& charts, const Bin& bin, const Polisher& polisher,
         const Layout& start, const TilePlan& plan, const Context& context)
      : bin_(bin),
        polisher_(polisher),
        context_(context),
        rotations_(2 * plan.rotations),
        lanes_(plan.effort < small_effort ? most_lanes / 2 : most_lanes) {
    plan_.rotations = 32;
    if (plan.upright) rotations_ = plan_.rotations = 4;
    free_ = !plan.upright;
    cells_ = charts.size() <= 60 ? 256 : 384;
    const double cell = (bin.side + bin.gutter) / cells_;
    shapes_ = make_shapes(charts, 0.1 * cell / start.scale, bin.gutter / start.scale, plan.upright);
    for (Lane& lane : lanes_) lane.best = start;
    double square = 0.0;
    for (const Outline& chart : charts) {
      square = std::max(square, least_square(chart.hull).size.maxCoeff());
    }
    most_scale_ = bin.side / square;
  }

  Layout run(double effort) {
    if (done()) return lanes_[0].best;
    const int charts = static_cast<int>(shapes_.size());
    const double variants = effort * std::clamp(800.0 / charts, 4.0, 32.0);
    const int orders = effort < small_effort ? 0 : static_cast<int>(std::lround(variants));
    if (orders > 0) open(orders);
    // A few charts have few ways to lie: more work finds nothing new.
    const double budget = effort * standard_work * std::min(1.0, charts / 6.0);
    plan_.cells = cells_;
    plan_.trials = 8;
    plan_.work = std::clamp<int64_t>(work_per_chart * charts, least_work, most_work);
    plan_.work =
        std::clamp<int64_t>(static_cast<int64_t>(budget / lane_count()), least_share, plan_.work);
    double work = 0.0;
    for (int round = 0; work < budget && !done() && !context_.stopping(); ++round) {
      parallel_for(context_, lane_count(), [&](int lane) {
        SeparationPlan own = plan_;
        own.seed = scramble(static_cast<uint64_t>(round) * lane_count() + lane);
        own.askew = free_ && round % 2 == 1;
        advance(lanes_[lane], own);
      });
      for (Lane& lane : lanes_) {
        work += static_cast<double>(lane.work);
        beware(lane.caught);
      }
      const bool hopeless = std::all_of(lanes_.begin(), lanes_.end(),
                                        [](const Lane& lane) { return lane.failures >= patience; });
      if (hopeless && charts > many) break;
      if (round % exchange == exchange - 1) follow_best();
    }
    return lanes_[best_lane()].best;
  }

 private:
  static constexpr int most_lanes = 4;
  // A small effort gets further in two lanes than with half the steps in each of four, and
  // without shuffled orders.
  static constexpr double small_effort = 0.05;
  static constexpr int exchange = 4;  // rounds between exchanges
  static constexpr int tighten_steps = 40;
  static constexpr int many = 100;    // charts that seldom come apart if they do not soon
  static constexpr int patience = 2;  // failures after which a lane also tries scattered charts
  // Sums that a separation adds up; about 3e9 of them take a second on one core.
  static constexpr int64_t work_per_chart = 10'000'000;
  static constexpr int64_t least_work = 40'000'000;
  static constexpr int64_t most_work = 400'000'000;
  static constexpr int64_t least_share = 10'000'000;  // of a lane, where there is less to spend
  static constexpr double standard_work = 6e9;        // over all lanes, at effort 1

  const Bin& bin_;
  const Polisher& polisher_;
  const Context& context_;
  int rotations_;  // of greedy passes
  bool free_ = true;
  int cells_;
  std::vector<Shape> shapes_;
  std::vector<Lane> lanes_;
  SeparationPlan plan_;
  double most_scale_ = INFINITY;  // at which every chart alone has room

  int lane_count() const { return static_cast<int>(lanes_.size()); }
  bool done() const { return lanes_[best_lane()].best.scale >= 0.9995 * most_scale_; }

  /// Greedy passes in shuffled orders, all at the same scale; as long as some succeed, the scale
  /// grows. Each lane starts from the last success in its share of the orders. When charts turn out
  /// to be caught, once more with care for them.
  void open(int variants) {
    double scale = 0.96 * lanes_[0].best.scale;
    for (int round = 0; round < 3 && !context_.stopping(); ++round) {
      std::vector<Layout> found = shuffled_orders(variants, scale);
      std::vector<std::vector<int>> caught(lane_count());
      std::vector<char> adopted(lane_count(), 0);
      parallel_for(context_, lane_count(), [&](int lane) {
        std::vector<int> own;
        for (int v = lane; v < variants; v += lane_count()) {
          if (found[v].scale > 0.0) own.push_back(v);
        }
        std::stable_sort(own.begin(), own.end(),
                         [&](int a, int b) { return found[a].scale > found[b].scale; });
        own.resize(std::min<size_t>(own.size(), 3));
        for (int v : own) {
          adopted[lane] = adopt(lanes_[lane], std::move(found[v]));
          caught[lane] = lanes_[lane].caught;
          if (adopted[lane]) break;
        }
      });
      for (const std::vector<int>& charts : caught) beware(charts);
      if (std::find(adopted.begin(), adopted.end(), 1) != adopted.end()) break;
      if (std::all_of(caught.begin(), caught.end(), [](auto& c) { return c.empty(); })) break;
    }
  }

  std::vector<Layout> shuffled_orders(int variants, double scale) {
    constexpr double stride = 1.01;
    std::vector<Layout> found(variants);
    for (bool any = true; any && !context_.stopping(); scale *= stride) {
      const MaskSet masks(shapes_, bin_, scale, cells_, rotations_, Cover::centres, context_);
      std::vector<char> fits(variants, 0);
      parallel_for(context_, variants, [&](int variant) {
        Layout layout = greedy(shapes_, masks, static_cast<uint64_t>(variant), context_);
        if (layout.scale <= 0.0) return;
        fits[variant] = 1;
        found[variant] = std::move(layout);
      });
      any = std::find(fits.begin(), fits.end(), 1) != fits.end();
    }
    return found;
  }

  void beware(const std::vector<int>& charts) {
    for (int chart : charts) shapes_[chart].wary = true;
  }

  /// Tighten a layout from a raster pass, and make it the lane's best if it is.
  bool adopt(Lane& lane, Layout layout) const {
    Pushed pushed = polisher_.tighten(layout, tighten_steps, Caught::move_elsewhere, context_);
    lane.caught = std::move(pushed.caught);
    lane.work += pushed.work;
    if (layout.scale <= lane.best.scale) return false;
    lane.best = std::move(layout);
    return true;
  }

  void advance(Lane& lane, const SeparationPlan& plan) {
    constexpr double least_growth = 0.004;
    constexpr double most_growth = 0.04;
    Layout start = lane.best;
    const bool anew = plan.askew && lane.failures > patience;
    if (anew) {
      scatter(plan.seed, start);
    } else {
      start.scale = std::min((1.0 + lane.growth) * start.scale, 0.9999 * most_scale_);
    }
    Separation found = separate(shapes_, bin_, start, plan, context_);
    lane.work = found.work;
    const bool apart = found.layout.scale > 0.0;
    const bool better = adopt(lane, std::move(found.layout));
    lane.failures = better ? 0 : lane.failures + 1;
    if (anew) return;
    if (better) {
      lane.growth = std::min(most_growth, 1.3 * lane.growth);
    } else {
      lane.growth = std::clamp((apart ? 1.1 : 0.7) * lane.growth, least_growth, most_growth);
    }
  }

  /// Charts anywhere and in any turn, a little smaller: where they come apart, tightening may make
  /// them larger than all moves from the present places do.
  void scatter(uint64_t seed, Layout& layout) const {
    constexpr double most_shrink = 0.08;
    Random random(seed);
    layout.scale *= 1.0 - most_shrink * random.uniform();
    for (Pose& pose : layout.poses) {
      pose.rotation_rad = 2.0 * std::numbers::pi * random.uniform();
      pose.centre = bin_.side * Vec2(random.uniform(), random.uniform());
    }
  }

  int best_lane() const {
    int best = 0;
    for (int lane = 1; lane < lane_count(); ++lane) {
      if (lanes_[lane].best.scale > lanes_[best].best.scale) best = lane;
    }
    return best;
  }

  /// The worst lane goes on from the best one's layout.
  void follow_best() {
    const int best = best_lane();
    int worst = 0;
    for (int lane = 1; lane < lane_count(); ++lane) {
      if (lanes_[lane].best.scale < lanes_[worst].best.scale) worst = lane;
    }
    if (worst != best) lanes_[worst].best = lanes_[best].best;
  }
};

}  // namespace

Layout search(const std::vector<Outline>& charts, const Bin& bin, const Polisher& polisher,
              const Layout& start, const TilePlan& plan, const Context& context) {
  return Search(charts, bin, polisher, start, plan, context).run(plan.effort);
}

}  // namespace partuv::packing
