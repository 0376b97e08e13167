#include "pack/compact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "pack/distance.hpp"
#include "pack/motion_program.hpp"

namespace partuv::packing {

namespace {

/// A corner of one chart (the start of side `corner`) and a side of another that may meet.
struct Contact {
  int32_t corner;
  int32_t side;
};

/// What tells limits apart: those that agree in all of it say nearly the same.
struct Likeness {
  std::array<int64_t, 5> key;
  double distance;
  int32_t contact;
};

/// Where on side `s` the point p is nearest, as a share of the side.
double nearest_share(const Vec2& p, const Segment& s) {
  const Vec2 along = s.b - s.a;
  const double squared = along.squaredNorm();
  return squared > 0.0 ? std::clamp((p - s.a).dot(along) / squared, 0.0, 1.0) : 0.0;
}

class Compactor {
 public:
  Compactor(const std::vector<Loops>& loops, const Bin& bin, bool upright, double trust,
            const Context& context)
      : loops_(loops),
        bin_(bin),
        upright_(upright),
        context_(context),
        trust_(trust),
        least_trust_(0.01 * trust_) {
    for (const Loops& chart : loops) {
      double radius = 0.0;
      for (const Vec2& p : chart.points) radius = std::max(radius, p.norm());
      radius_.push_back(radius);
      hulls_.push_back(convex_hull(chart.points));
    }
  }

  /// One program. Returns false when the trust region has become too small to matter.
  bool step(Layout& layout) {
    const PlacedSides placed = place_sides(loops_, layout);
    collect(placed);
    const std::vector<MotionLimit> limits = limits_of(placed, layout);
    const Motion motion = solve(limits);
    Layout moved = layout;
    move(motion, moved);
    moved.scale = fit(moved, layout.scale * (1.0 + std::max(0.0, motion.growth) / growth_arm()));
    const double gain = moved.scale / layout.scale - 1.0;
    if (motion.solved && gain > 0.0) {
      layout = std::move(moved);
      if (gain * growth_arm() < 0.25 * motion.growth) trust_ *= 0.5;
      if (gain < least_gain) trust_ *= 0.5;
    } else {
      trust_ *= 0.35;
    }
    return trust_ > least_trust_;
  }

  /// One program whose motion is taken as it is. Returns whether it was solved.
  bool nudge(Layout& layout) {
    const PlacedSides placed = place_sides(loops_, layout);
    collect(placed);
    const Motion motion = solve(limits_of(placed, layout));
    if (!motion.solved) return false;
    move(motion, layout);
    layout.scale *= 1.0 + motion.growth / growth_arm();
    return true;
  }

  /// One program that lets the worst miss of gutter or bin shrink most. Returns false when there is
  /// none left, or none that a motion mends.
  bool push(Layout& layout) {
    const PlacedSides placed = place_sides(loops_, layout);
    collect(placed);
    const double miss = worst_miss(placed, layout);
    if (miss <= 0.0) return false;
    std::vector<MotionLimit> limits = limits_of(placed, layout);
    for (MotionLimit& limit : limits) {
      limit.growth = -1.0;
      limit.least -= miss;
    }
    const Motion motion = solve(limits);
    // Charts that the linear picture holds fast do not come free of it.
    constexpr double hardly = 0.03;
    if (motion.solved && motion.growth < hardly * std::min(miss, trust_)) return false;
    Layout moved = layout;
    move(motion, moved);
    const double left = motion.solved ? worst_miss(place_sides(loops_, moved), moved) : miss;
    if (left < miss) layout = std::move(moved);
    constexpr double much = 0.1;
    if (left > (1.0 - much) * miss) trust_ *= 0.3;
    return trust_ > least_trust_;
  }

  int64_t work() const { return work_; }
  /// Whether more has been done than outlines with a sensible number of sides take.
  bool tired() const { return work_ > most_work; }

  /// The smaller charts of the pairs that miss most, and charts that leave the bin.
  std::vector<int> stuck(const Layout& layout) {
    const PlacedSides placed = place_sides(loops_, layout);
    collect(placed);
    const double bound = 0.95 * worst_miss(placed, layout);
    std::vector<int> charts;
    if (bound <= 0.0) return charts;
    for_each_corner(layout, [&](int32_t chart, const Vec2& p) {
      if (wall_miss(p) >= bound) charts.push_back(chart);
    });
    for (const NearPair& pair : pairs_) {
      if (bin_.gutter - pair.distance < bound) continue;
      const int one = placed.chart[pair.one];
      const int two = placed.chart[pair.two];
      charts.push_back(radius_[one] < radius_[two] ? one : two);
    }
    std::sort(charts.begin(), charts.end());
    charts.erase(std::unique(charts.begin(), charts.end()), charts.end());
    return charts;
  }

 private:
  /// The largest scale up to `scale` at which the contacts keep the gutter and the bin, or a little
  /// less than all that would matter.
  double fit(Layout layout, double scale) const {
    layout.scale = scale;
    if (keeps(layout)) return scale;
    double low = 0.97 * scale;
    double high = scale;
    constexpr int halvings = 13;
    for (int i = 0; i < halvings; ++i) {
      layout.scale = 0.5 * (low + high);
      (keeps(layout) ? low : high) = layout.scale;
    }
    return low;
  }

  static constexpr double least_gain = 2e-5;
  static constexpr int64_t most_work = 6'000'000'000;
  static constexpr int64_t work_per_side = 600, work_per_pair = 600;
  static constexpr int64_t work_per_limit = 300, work_per_chart = 3000;

  const std::vector<Loops>& loops_;
  const Bin& bin_;
  bool upright_;
  const Context& context_;
  std::vector<double> radius_;  // of each chart, unscaled
  std::vector<std::vector<Vec2>> hulls_;
  int64_t work_ = 0;
  std::vector<NearPair> pairs_;
  std::vector<Contact> contacts_;
  double trust_;        // how far charts may move in one step, texels
  double least_trust_;  // below it a motion does not matter

  /// A turn by this many texels at the rim is a unit step of a chart's third variable.
  double arm(size_t chart, const Layout& layout) const {
    return std::max(1.0, radius_[chart] * layout.scale);
  }
  double growth_arm() const { return std::max(1.0, 0.5 * bin_.side); }

  Motion solve(const std::vector<MotionLimit>& limits) {
    Motion motion = solve_motion(limits, static_cast<int>(loops_.size()), trust_, context_);
    work_ += motion.steps * (work_per_limit * static_cast<int64_t>(limits.size()) +
                             work_per_chart * static_cast<int64_t>(loops_.size()));
    return motion;
  }

  void move(const Motion& motion, Layout& layout) const {
    for (size_t i = 0; i < loops_.size(); ++i) {
      layout.poses[i].centre += Vec2(motion.charts[i][0], motion.charts[i][1]);
      if (!upright_) layout.poses[i].rotation_rad += motion.charts[i][2] / arm(i, layout);
    }
  }

  double wall_miss(const Vec2& p) const {
    return bin_.wall - std::min(p.minCoeff(), bin_.side - p.maxCoeff());
  }

  /// Calls body(chart, corner) for the corners of all hulls as placed.
  template <typename Body>
  void for_each_corner(const Layout& layout, Body&& body) const {
    for (size_t i = 0; i < hulls_.size(); ++i) {
      const Turn turn(layout.poses[i].rotation_rad, layout.scale);
      for (const Vec2& p : hulls_[i]) {
        body(static_cast<int32_t>(i), Vec2(turn(p) + layout.poses[i].centre));
      }
    }
  }

  /// By how much the gutter or the bin is missed at worst, in texels; at most 0 when all is well.
  double worst_miss(const PlacedSides& placed, const Layout& layout) const {
    double miss = -INFINITY;
    for_each_corner(layout, [&](int32_t, const Vec2& p) { miss = std::max(miss, wall_miss(p)); });
    for (const Contact& contact : contacts_) {
      const Vec2& p = placed.sides[contact.corner].a;
      miss = std::max(miss, bin_.gutter - point_distance(p, placed.sides[contact.side]));
    }
    // Slivers may cross with all their corners far from each other.
    for (const NearPair& pair : pairs_) {
      if (miss < bin_.gutter && cross(placed.sides[pair.one], placed.sides[pair.two])) {
        miss = bin_.gutter;
      }
    }
    return miss;
  }

  /// Corners and sides that one step could bring together: where the distance from the corner to
  /// the other outline has a local minimum, so that straight runs of sides do not block sliding.
  void collect(const PlacedSides& placed) {
    contacts_.clear();
    auto add = [&](int32_t corner, int32_t side) {
      const Vec2& p = placed.sides[corner].a;
      const Segment& s = placed.sides[side];
      const double share = nearest_share(p, s);
      if (share >= 1.0) return;  // the next side has this point as its start
      if (share <= 0.0) {
        const Segment& before = placed.sides[placed.previous[side]];
        if ((p - before.b).dot(before.b - before.a) < 0.0) return;
      }
      contacts_.push_back({corner, side});
    };
    pairs_ = near_pairs(placed, bin_.gutter + 3.0 * trust_);
    work_ += work_per_side * static_cast<int64_t>(placed.sides.size()) +
             work_per_pair * static_cast<int64_t>(pairs_.size());
    for (const NearPair& pair : pairs_) {
      add(pair.one, pair.two);
      add(pair.two, pair.one);
    }
  }

  MotionLimit limit(const Contact& contact, const PlacedSides& placed, const Layout& layout) const {
    const Vec2& p = placed.sides[contact.corner].a;
    const Segment& s = placed.sides[contact.side];
    const Vec2 q = s.a + nearest_share(p, s) * (s.b - s.a);
    const double distance = (p - q).norm();
    Vec2 normal(s.b.y() - s.a.y(), s.a.x() - s.b.x());  // outwards: the inside is on the left
    if (distance > 0.0) normal = p - q;
    normal.normalize();
    MotionLimit limit;
    limit.one = placed.chart[contact.corner];
    limit.two = placed.chart[contact.side];
    const Vec2 from_one = p - layout.poses[limit.one].centre;
    const Vec2 from_two = q - layout.poses[limit.two].centre;
    limit.a = {normal.x(), normal.y(), turn_rate(normal, from_one) / arm(limit.one, layout)};
    limit.b = {-normal.x(), -normal.y(), -turn_rate(normal, from_two) / arm(limit.two, layout)};
    limit.growth = normal.dot(from_one - from_two) / growth_arm();
    limit.least = bin_.gutter - distance;
    return limit;
  }

  double turn_rate(const Vec2& normal, const Vec2& from_centre) const {
    if (upright_) return 0.0;
    return normal.y() * from_centre.x() - normal.x() * from_centre.y();
  }

  /// The limits of all contacts and walls, without those that a nearer one like them makes idle.
  std::vector<MotionLimit> limits_of(const PlacedSides& placed, const Layout& layout) const {
    std::vector<Likeness> order;
    order.reserve(contacts_.size());
    const double cell = 0.5 * trust_;
    for (size_t i = 0; i < contacts_.size(); ++i) {
      const Contact& contact = contacts_[i];
      const Vec2& p = placed.sides[contact.corner].a;
      const Segment& s = placed.sides[contact.side];
      const Vec2 away = p - s.a - nearest_share(p, s) * (s.b - s.a);
      constexpr double sectors_per_rad = 4.0;
      const std::array<int64_t, 5> key{
          placed.chart[contact.corner], placed.chart[contact.side], std::llround(p.x() / cell),
          std::llround(p.y() / cell),
          std::llround(sectors_per_rad * std::atan2(away.y(), away.x()))};
      order.push_back({key, away.norm(), static_cast<int32_t>(i)});
    }
    std::sort(order.begin(), order.end(), [](const Likeness& a, const Likeness& b) {
      return std::tie(a.key, a.distance, a.contact) < std::tie(b.key, b.distance, b.contact);
    });
    std::vector<MotionLimit> limits;
    for (size_t i = 0; i < order.size(); ++i) {
      if (i > 0 && order[i].key == order[i - 1].key) continue;
      limits.push_back(limit(contacts_[order[i].contact], placed, layout));
    }
    add_walls(layout, limits);
    return limits;
  }

  /// A chart reaches a wall with a corner of its hull first.
  void add_walls(const Layout& layout, std::vector<MotionLimit>& limits) const {
    const double reach = 3.0 * trust_;
    for_each_corner(layout, [&](int32_t chart, const Vec2& p) {
      auto add = [&](const Vec2& normal, double room) {
        if (room > reach) return;
        const Vec2 from = p - layout.poses[chart].centre;
        MotionLimit limit;
        limit.one = chart;
        limit.two = -1;
        limit.a = {normal.x(), normal.y(), turn_rate(normal, from) / arm(chart, layout)};
        limit.b = {};
        limit.growth = normal.dot(from) / growth_arm();
        limit.least = -room;
        limits.push_back(limit);
      };
      add(Vec2(1, 0), p.x() - bin_.wall);
      add(Vec2(0, 1), p.y() - bin_.wall);
      add(Vec2(-1, 0), bin_.side - bin_.wall - p.x());
      add(Vec2(0, -1), bin_.side - bin_.wall - p.y());
    });
  }

  bool keeps(const Layout& layout) const {
    return worst_miss(place_sides(loops_, layout), layout) <= 0.0;
  }
};

}  // namespace

int64_t compact(const std::vector<Loops>& loops, const Bin& bin, bool upright, int steps,
                double trust, Layout& layout, const Context& context) {
  if (layout.scale <= 0.0 || loops.empty()) return 0;
  Compactor compactor(loops, bin, upright, trust, context);
  for (int i = 0; i < steps && !context.stopping() && !compactor.tired(); ++i) {
    if (!compactor.step(layout)) break;
  }
  return compactor.work();
}

bool nudge(const std::vector<Loops>& loops, const Bin& bin, double trust, Layout& layout,
           const Context& context) {
  return Compactor(loops, bin, false, trust, context).nudge(layout);
}

Pushed push_apart(const std::vector<Loops>& loops, const Bin& bin, bool upright, int steps,
                  double trust, Layout& layout, const Context& context) {
  Compactor compactor(loops, bin, upright, trust, context);
  for (int i = 0; i < steps && !context.stopping() && !compactor.tired(); ++i) {
    if (!compactor.push(layout)) break;
  }
  return {compactor.stuck(layout), compactor.work()};
}

}  // namespace partuv::packing
