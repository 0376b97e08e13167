#include "mesh/canonical_order.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace partuv::detail {
namespace {

/// The logarithm in steps of a thousandth: what is alike by symmetry must not be told apart by
/// rounding.
int64_t rounded_log(double value) { return std::llround(1e3 * std::log(std::max(value, 1e-300))); }

/// A region's area, and the centre of that area.
struct Bulk {
  double area = 0.0;
  Vec3 centre = Vec3::Zero();

  void add(double face_area, const Vec3& face_centre) {
    area += face_area;
    centre += face_area * face_centre;
  }
  void finish() {
    if (area > 0.0) centre /= area;
  }
};

/// Visits a component from one side on, ring by ring: each face is entered by a side, and its
/// neighbours follow in the order of the sides from there on.
class Walk {
 public:
  explicit Walk(const Surface& surface) : surface_(surface), place_(surface.faces.size(), -1) {}

  void start(int side) {
    for (const int h : order_) place_[h / 3] = -1;
    order_.clear();
    next_ = 0;
    enter(side);
  }

  bool done() const { return next_ == order_.size(); }

  /// Visit the next face. Calls meet(code) for each of its sides with what lies across in terms of
  /// the walk itself: the number of a face and of one of its sides, or -1.
  template <typename Meet>
  void step(const Meet& meet) {
    const int f = order_[next_] / 3, first = order_[next_] % 3;
    ++next_;
    for (int k = 0; k < 3; ++k) {
      const int across = surface_.opposite[f][(first + k) % 3];
      if (across >= 0 && place_[across / 3] < 0) enter(across);
      meet(across < 0 ? -1 : code(across));
    }
  }

  /// The sides entered so far.
  const std::vector<int32_t>& order() const { return order_; }

 private:
  void enter(int side) {
    place_[side / 3] = static_cast<int32_t>(order_.size());
    order_.push_back(side);
  }
  int32_t code(int side) const {
    const int place = place_[side / 3];
    return 3 * place + (side % 3 + 3 - order_[place] % 3) % 3;
  }

  const Surface& surface_;
  std::vector<int32_t> place_;  ///< per face, -1 before it is entered
  std::vector<int32_t> order_;
  size_t next_ = 0;
};

/// Among sides of a component that are alike by their measures the one from which the connectivity,
/// numbered along the walk, comes first as a word. Sides with the same word are alike by symmetry.
class NumberingContest {
 public:
  explicit NumberingContest(const Surface& surface)
      : walk_(surface), steps_left_(steps_per_face * surface.face_count() + least_steps) {}

  int winner(const std::vector<int32_t>& sides) {
    int best = sides.front();
    if (sides.size() == 1) return best;
    word_.clear();
    for (const int side : sides) {
      if (steps_left_ <= 0) break;
      if (comes_first(side)) best = side;
    }
    return best;
  }

 private:
  // A surface of high symmetry has many such sides, and they are all as good.
  static constexpr int64_t steps_per_face = 32, least_steps = 1'000'000;

  /// True if the word from `side` comes before `word_`, which then becomes that word.
  bool comes_first(int side) {
    bool ahead = word_.empty(), behind = false;
    size_t at = 0;
    walk_.start(side);
    while (!walk_.done() && !behind) {
      --steps_left_;
      walk_.step([&](int32_t code) {
        if (!ahead && !behind && code != word_[at]) {
          ahead = code < word_[at];
          behind = !ahead;
        }
        if (ahead) {
          word_.resize(at);
          word_.push_back(code);
        }
        ++at;
      });
    }
    return ahead;
  }

  Walk walk_;
  std::vector<int32_t> word_;
  int64_t steps_left_;
};

class Orderer {
 public:
  explicit Orderer(const Surface& surface)
      : surface_(surface), area_(surface.faces.size()), centre_(surface.faces.size()) {
    component_count_ = label_components(surface, component_);
    bulk_.resize(component_count_);
    for (int f = 0; f < surface.face_count(); ++f) {
      const Triangle& t = surface.faces[f];
      const Vec3 sum = surface.positions[t[0]] + surface.positions[t[1]] + surface.positions[t[2]];
      // Relative to one point, so that a place far from the origin costs no digits.
      centre_[f] = sum / 3.0 - origin();
      area_[f] = 0.5 * face_cross(surface, f).norm();
      bulk_[component_[f]].add(area_[f], centre_[f]);
      whole_.add(area_[f], centre_[f]);
    }
    for (Bulk& bulk : bulk_) bulk.finish();
    whole_.finish();
    find_lean();
  }

  /// The faces in their order, each by the side that it was entered by.
  std::vector<int32_t> run() {
    const std::vector<int32_t> seed = seed_sides();
    std::vector<int32_t> order;
    order.reserve(surface_.faces.size());
    Walk walk(surface_);
    for (const int c : component_order()) {
      walk.start(seed[c]);
      while (!walk.done()) walk.step([](int32_t) {});
      order.insert(order.end(), walk.order().begin(), walk.order().end());
    }
    return order;
  }

 private:
  const Vec3& origin() const { return surface_.positions.front(); }

  /// Moments of the area of two odd orders, over the powers of its radius of gyration.
  void find_lean() {
    double squares = 0.0;
    for (size_t f = 0; f < area_.size(); ++f) {
      squares += area_[f] * (centre_[f] - whole_.centre).squaredNorm();
    }
    if (!(squares > 0.0)) return;
    per_radius_ = std::sqrt(whole_.area / squares);
    for (size_t f = 0; f < area_.size(); ++f) {
      const Vec3 unit = (centre_[f] - whole_.centre) * per_radius_;
      const double square = unit.squaredNorm(), share = area_[f] / whole_.area;
      lean_[0] += share * square * unit;
      lean_[1] += share * square * square * unit;
    }
  }

  /// Which side of the mirror a point lies on, from -1 to 1: its volume with two directions that
  /// any mirror symmetry of the surface keeps. 0 where symmetries leave no such directions.
  double handedness(const Vec3& from_centre) const {
    const Vec3 normal = lean_[0].cross(lean_[1]);
    const double length = normal.norm() * from_centre.norm();
    constexpr double least_lean = 1e-4;  // directions below are rounding, or hardly there
    if (lean_[0].norm() < least_lean || !(normal.norm() > least_lean * least_lean)) return 0.0;
    return normal.dot(from_centre) / length;
  }

  /// Of each component the side that starts where it reaches farthest from its centre; of several
  /// such the one on the left of the whole surface, then the one with the largest face, then the
  /// longest, then the one whose numbering comes first.
  std::vector<int32_t> seed_sides() const {
    using Key = std::tuple<int64_t, int64_t, int64_t, int64_t>;
    std::vector<std::vector<int32_t>> seeds(component_count_);
    std::vector<Key> best(component_count_);
    for (int f = 0; f < surface_.face_count(); ++f) {
      const int c = component_[f];
      const int64_t area = rounded_log(2.0 * area_[f] * per_radius_ * per_radius_);
      for (int k = 0; k < 3; ++k) {
        const Vec3 from = surface_.positions[surface_.faces[f][k]] - origin();
        const Vec3 to = surface_.positions[surface_.faces[f][(k + 1) % 3]] - origin();
        const Key key{rounded_log((from - bulk_[c].centre).norm() * per_radius_),
                      std::llround(100.0 * handedness(from - whole_.centre)), area,
                      rounded_log((to - from).norm() * per_radius_)};
        if (!seeds[c].empty() && key < best[c]) continue;
        if (key != best[c]) seeds[c].clear();
        seeds[c].push_back(3 * f + k);
        best[c] = key;
      }
    }
    NumberingContest contest(surface_);
    std::vector<int32_t> winner;
    for (const auto& sides : seeds) winner.push_back(contest.winner(sides));
    return winner;
  }

  /// Components with the largest first; of several as large, the one farthest out.
  std::vector<int32_t> component_order() const {
    std::vector<std::tuple<int64_t, int64_t, int32_t>> key(component_count_);
    for (int c = 0; c < component_count_; ++c) {
      key[c] = {-rounded_log(bulk_[c].area / whole_.area),
                -rounded_log((bulk_[c].centre - whole_.centre).norm() * per_radius_), c};
    }
    std::sort(key.begin(), key.end());
    std::vector<int32_t> order;
    for (const auto& [area, distance, c] : key) order.push_back(c);
    return order;
  }

  const Surface& surface_;
  std::vector<double> area_;  ///< per face
  std::vector<Vec3> centre_;  ///< per face, from the origin
  std::vector<int32_t> component_;
  int component_count_ = 0;
  std::vector<Bulk> bulk_;
  Bulk whole_;
  double per_radius_ = 1.0;  ///< one over the whole's radius of gyration
  Vec3 lean_[2] = {Vec3::Zero(), Vec3::Zero()};
};

}  // namespace

void number_canonically(Topology& topology) {
  const std::vector<int32_t> order = Orderer(topology.surface).run();
  const Surface from = std::exchange(topology.surface, {});
  const std::vector<int32_t> source_face = std::exchange(topology.source_face, {});
  const std::vector<int32_t> source_vertex = std::exchange(topology.source_vertex, {});
  const std::vector<int8_t> first_corner = std::exchange(topology.first_corner, {});
  std::vector<int32_t> side_zero(order.size()), place(order.size());  // by old face
  for (size_t i = 0; i < order.size(); ++i) {
    place[order[i] / 3] = static_cast<int32_t>(i);
    side_zero[order[i] / 3] = order[i] % 3;
  }
  std::vector<int32_t> vertex(from.positions.size(), -1);
  Surface& surface = topology.surface;
  for (const int side : order) {
    const int f = side / 3;
    Triangle face, opposite;
    for (int k = 0; k < 3; ++k) {
      const int corner = (side % 3 + k) % 3;
      const int v = from.faces[f][corner], h = from.opposite[f][corner];
      if (vertex[v] < 0) {
        vertex[v] = surface.vertex_count();
        surface.positions.push_back(from.positions[v]);
        topology.source_vertex.push_back(source_vertex[v]);
      }
      face[k] = vertex[v];
      opposite[k] = h < 0 ? -1 : 3 * place[h / 3] + (h % 3 + 3 - side_zero[h / 3]) % 3;
    }
    surface.faces.push_back(face);
    surface.opposite.push_back(opposite);
    topology.source_face.push_back(source_face[f]);
    topology.first_corner.push_back(static_cast<int8_t>((first_corner[f] + side % 3) % 3));
  }
}

}  // namespace partuv::detail
