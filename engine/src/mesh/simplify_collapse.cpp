#include "mesh/simplify_collapse.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "rounded.hpp"

namespace partuv::detail {

double triangle_quality(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  if (!(sides > 0.0)) return 0.0;
  return 2.0 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / sides;
}

namespace {

/// Area-weighted sum of squared distances to planes, around a point of its own (Garland and
/// Heckbert 1997; the moving origin keeps small components precise far from the centre).
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 linear = Vec3::Zero();
  double constant = 0;
  double area = 0;

  void add_plane(const Vec3& n, double weight) {
    xx += weight * n[0] * n[0];
    xy += weight * n[0] * n[1];
    xz += weight * n[0] * n[2];
    yy += weight * n[1] * n[1];
    yz += weight * n[1] * n[2];
    zz += weight * n[2] * n[2];
  }
  Vec3 times(const Vec3& d) const {
    return {xx * d[0] + xy * d[1] + xz * d[2], xy * d[0] + yy * d[1] + yz * d[2],
            xz * d[0] + yz * d[1] + zz * d[2]};
  }
  double at(const Vec3& d) const {
    return std::max(0.0, d.dot(times(d) + 2.0 * linear) + constant);
  }
  /// Add a quadric whose origin lies at `-d` from ours.
  void add_moved(const Quadric& other, const Vec3& d) {
    constant += other.at(d);
    linear += other.linear + other.times(d);
    xx += other.xx, xy += other.xy, xz += other.xz;
    yy += other.yy, yz += other.yz, zz += other.zz;
    area += other.area;
  }
};

std::vector<Quadric> vertex_quadrics(const EditableSurface& surface) {
  std::vector<Quadric> quadrics(surface.vertex_count());
  // A plane through a boundary edge, upright on its face, holds the boundary in place.
  constexpr double boundary_weight = 4.0;
  for (int f = 0; f < surface.face_slots(); ++f) {
    const Triangle& t = surface.face(f);
    const Vec3 p[3] = {surface.position(t[0]), surface.position(t[1]), surface.position(t[2])};
    const Vec3 cross = (p[1] - p[0]).cross(p[2] - p[0]);
    const double length = cross.norm();
    if (!(length > 0.0)) continue;
    const Vec3 normal = cross / length;
    const double third = length / 6.0;
    for (int i = 0; i < 3; ++i) {
      quadrics[t[i]].add_plane(normal, third);
      quadrics[t[i]].area += third;
      if (surface.opposite(3 * f + i) >= 0) continue;
      const Vec3 edge = p[(i + 1) % 3] - p[i];
      const double weight = boundary_weight * edge.squaredNorm();
      const Vec3 upright = edge.cross(normal).normalized();
      quadrics[t[i]].add_plane(upright, weight);
      quadrics[t[(i + 1) % 3]].add_plane(upright, weight);
    }
  }
  return quadrics;
}

/// Vertices by cost in logarithmic buckets, first in first out; each vertex at most once.
class BucketQueue {
 public:
  explicit BucketQueue(int vertices)
      : next_(vertices, absent), head_(buckets, none), tail_(buckets) {}

  static int bucket(float cost) {
    const float key = std::min(cost, 1e30f);
    uint32_t bits;
    std::memcpy(&bits, &key, sizeof bits);
    return static_cast<int>(bits >> shift);
  }
  bool holds(int v) const { return next_[v] != absent; }
  void push(int v, int bucket) {
    next_[v] = none;
    if (head_[bucket] == none) {
      head_[bucket] = v;
    } else {
      next_[tail_[bucket]] = v;
    }
    tail_[bucket] = v;
    lowest_ = std::min(lowest_, bucket);
  }
  /// The cheapest vertex, or -1.
  int pop(int& bucket) {
    while (lowest_ < buckets && head_[lowest_] == none) ++lowest_;
    if (lowest_ == buckets) return -1;
    bucket = lowest_;
    const int v = head_[lowest_];
    head_[lowest_] = next_[v];
    next_[v] = absent;
    return v;
  }

 private:
  static constexpr int shift = 23;  // a bucket per factor of two: rounding seldom moves a vertex
  static constexpr int buckets = 1 << (31 - shift);
  static constexpr int none = -1, absent = -2;
  std::vector<int32_t> next_, head_, tail_;
  int lowest_ = buckets;
};

/// The cheapest valid collapse of one vertex.
struct Move {
  float cost = std::numeric_limits<float>::infinity();
  Spoke spoke;
  bool clears_needle = false;
};

class Collapser {
 public:
  Collapser(EditableSurface& surface, CollapseBudget& budget, std::vector<int32_t>& heir_of)
      : surface_(surface),
        budget_(budget),
        heir_of_(heir_of),
        quadrics_(vertex_quadrics(surface)),
        queue_(surface.vertex_count()),
        moves_(surface.vertex_count()),
        dirty_(surface.vertex_count(), 1) {}

  void run(const Context& context) {
    for (int v = 0; v < surface_.vertex_count(); ++v) {
      if (surface_.vertex_alive(v)) refresh(v, nothing_due);
    }
    int bucket = 0, steps = 0;
    for (int u = queue_.pop(bucket); u >= 0; u = queue_.pop(bucket)) {
      if ((++steps & 1023) == 0 && context.cancelled()) return;
      if (!surface_.vertex_alive(u)) continue;
      if (dirty_[u] && !refresh(u, bucket)) continue;
      if (moves_[u].clears_needle || wanted(u)) apply(u, bucket);
    }
  }

 private:
  struct Candidate {
    float cost;
    Spoke spoke;
    double squared_error;
  };

  static constexpr int nothing_due = -1;

  /// True while the budget asks for fewer faces where u is.
  bool wanted(int u) const {
    const ComponentBudget& component = budget_.components[budget_.component_of_vertex[u]];
    return surface_.alive_faces() > budget_.target_faces &&
           component.faces - 2 >= component.floor_faces;
  }

  /// Find u's best move. True if it belongs into `bucket` or below, else u waits in its own bucket.
  bool refresh(int u, int bucket) {
    moves_[u] = best_move(u);
    dirty_[u] = 0;
    if (!std::isfinite(moves_[u].cost)) return false;
    const int own = BucketQueue::bucket(moves_[u].cost);
    if (own <= bucket) return true;
    queue_.push(u, own);
    return false;
  }

  Move best_move(int u);
  double worst_new_quality(int v) const;
  void apply(int u, int bucket);

  EditableSurface& surface_;
  CollapseBudget& budget_;
  std::vector<int32_t>& heir_of_;
  std::vector<Quadric> quadrics_;
  BucketQueue queue_;
  std::vector<Move> moves_;
  std::vector<uint8_t> dirty_;

  // The star of the vertex under consideration.
  struct StarFace {
    int32_t a, b;  ///< the two other vertices
    Vec3 normal;   ///< unit, or zero for a sliver whose normal means nothing
  };
  std::vector<StarFace> star_;
  std::vector<Candidate> candidates_;
  std::vector<int32_t> ring_;
};

/// Quality of the worst triangle of the star when its centre sits at v; negative if one turns over.
double Collapser::worst_new_quality(int v) const {
  // A face may turn by 60 degrees in one step at most, and by what rounding adds to just those.
  constexpr double min_cosine = 0.4999;
  const Vec3& p = surface_.position(v);
  double worst = 1.0;
  for (const StarFace& face : star_) {
    if (face.a == v || face.b == v) continue;
    const Vec3 side_a = surface_.position(face.a) - p, side_b = surface_.position(face.b) - p;
    const Vec3 cross = side_a.cross(side_b);
    const double length = cross.norm();
    if (face.normal.dot(cross) < min_cosine * length * face.normal.squaredNorm()) return -1.0;
    const double sides =
        side_a.squaredNorm() + side_b.squaredNorm() + (side_b - side_a).squaredNorm();
    worst = std::min(worst, 2.0 * std::sqrt(3.0) * length / sides);
  }
  return worst;
}

Move Collapser::best_move(int u) {
  // A vertex with very many edges stays: it is the hub of a fan.
  constexpr int max_valence = 64;
  // What an edge of a flat region costs, as the square of the angle (rad) at which a curved one
  // costs as much: below it edges of equal length are equal, which keeps the triangles uniform.
  constexpr double flat_cost = 1e-3;
  constexpr double poor_quality = 0.2, min_quality = 0.05, needle_quality = 0.1;
  // Squared share of a component's extent that counts as nothing.
  constexpr double no_error = 1e-10;
  Move best;
  if (surface_.valence(u) > max_valence) return best;
  const double component_area = budget_.components[budget_.component_of_vertex[u]].area;

  star_.clear();
  double old_quality = 1.0;
  const Vec3& p = surface_.position(u);
  surface_.around(u, [&](int h) {
    const int a = surface_.to(h), b = surface_.from(EditableSurface::prev(h));
    const Vec3 side_a = surface_.position(a) - p, side_b = surface_.position(b) - p;
    const Vec3 cross = side_a.cross(side_b);
    const double length = cross.norm();
    const double sides =
        side_a.squaredNorm() + side_b.squaredNorm() + (side_b - side_a).squaredNorm();
    const double quality = sides > 0.0 ? 2.0 * std::sqrt(3.0) * length / sides : 0.0;
    old_quality = std::min(old_quality, quality);
    constexpr double meaningless = 1e-5;
    star_.push_back({a, b, quality > meaningless ? Vec3(cross / length) : Vec3::Zero()});
  });

  if (old_quality >= needle_quality && !wanted(u)) return best;

  const Quadric& quadric = quadrics_[u];
  const double max_error = budget_.max_error * budget_.max_error * component_area;
  candidates_.clear();
  surface_.around_edges(u, [&](const Spoke& spoke) {
    const Vec3 d = surface_.position(surface_.tip(spoke)) - p;
    const double error = quadric.at(d);
    if (error > max_error * quadric.area) return;
    const double cost =
        (error + flat_cost * (quadric.area + 1e-12) * d.squaredNorm()) / component_area;
    candidates_.push_back({rounded(cost), spoke, quadric.area > 0.0 ? error / quadric.area : 0.0});
  });
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.spoke.out < b.spoke.out;
  });
  const auto penalty = [](double quality) {
    const double ratio = poor_quality / std::max(quality, 1e-3);
    return 1.0 + ratio * ratio;
  };
  const double relief = 1.0 / penalty(old_quality);
  // The topology is looked at last: it is seldom in the way.
  while (true) {
    const Candidate* chosen = nullptr;
    float least_cost = std::numeric_limits<float>::infinity();
    double chosen_quality = 0.0;
    for (const Candidate& candidate : candidates_) {
      if (rounded(candidate.cost * relief) >= least_cost) break;
      const double quality = worst_new_quality(surface_.tip(candidate.spoke));
      if (quality < std::min(min_quality, 0.8 * old_quality)) continue;
      const float cost = rounded(candidate.cost * relief * penalty(quality));
      if (cost >= least_cost) continue;
      least_cost = cost;
      chosen = &candidate;
      chosen_quality = quality;
    }
    if (!chosen) return best;
    if (surface_.can_collapse(u, chosen->spoke)) {
      best.cost = least_cost;
      best.spoke = chosen->spoke;
      best.clears_needle = chosen->squared_error <= no_error * component_area &&
                           old_quality < needle_quality && chosen_quality > old_quality;
      return best;
    }
    candidates_.erase(candidates_.begin() + (chosen - candidates_.data()));
  }
}

void Collapser::apply(int u, int bucket) {
  const Spoke spoke = moves_[u].spoke;
  const int v = surface_.tip(spoke);
  ring_.clear();
  surface_.around_edges(u, [&](const Spoke& s) { ring_.push_back(surface_.tip(s)); });
  const int before = surface_.alive_faces();
  surface_.collapse(u, spoke, heir_of_);
  budget_.components[budget_.component_of_vertex[u]].faces -= before - surface_.alive_faces();
  quadrics_[v].add_moved(quadrics_[u], surface_.position(v) - surface_.position(u));
  for (const int n : ring_) {
    dirty_[n] = 1;
    if (!queue_.holds(n)) queue_.push(n, bucket);
  }
}

}  // namespace

void collapse_edges(EditableSurface& surface, CollapseBudget& budget, std::vector<int32_t>& heir_of,
                    const Context& context) {
  Collapser(surface, budget, heir_of).run(context);
}

void flip_poor_pairs(EditableSurface& surface, const Context& context) {
  // Cosine of the steepest edge that still counts as lying inside a flat region.
  constexpr double flat = 0.995;
  constexpr double poor_quality = 0.3, least_gain = 1.05;
  const auto cross = [&](int a, int b, int c) {
    const Vec3& p = surface.position(a);
    return Vec3((surface.position(b) - p).cross(surface.position(c) - p));
  };
  const auto quality = [&](int a, int b, int c) {
    return triangle_quality(surface.position(a), surface.position(b), surface.position(c));
  };
  std::vector<int32_t> stack;
  std::vector<uint8_t> waiting(3 * surface.face_slots(), 0);
  const auto push_sides = [&](int f) {
    for (int side = 3 * f; side < 3 * f + 3; ++side) {
      if (surface.opposite(side) < 0) continue;
      const int edge = std::min(side, surface.opposite(side));
      if (waiting[edge]) continue;
      waiting[edge] = 1;
      stack.push_back(edge);
    }
  };
  for (int f = surface.face_slots() - 1; f >= 0; --f) {
    if (!surface.face_alive(f)) continue;
    const Triangle& t = surface.face(f);
    if (quality(t[0], t[1], t[2]) < poor_quality) push_sides(f);
  }
  // The quality rises with every flip; the bound is there for the surfaces that are not quite flat.
  int64_t flips_left = 4 * static_cast<int64_t>(stack.size());
  for (int steps = 1; !stack.empty() && flips_left > 0; ++steps) {
    if ((steps & 4095) == 0 && context.cancelled()) return;
    const int h = stack.back();
    stack.pop_back();
    waiting[h] = 0;
    const int back = surface.opposite(h);
    if (back < 0) continue;  // an earlier flip has put another edge here
    const int a = surface.from(h), b = surface.to(h);
    const int c = surface.from(EditableSurface::prev(h));
    const int d = surface.from(EditableSurface::prev(back));
    const double before = std::min(quality(a, b, c), quality(b, a, d));
    if (before >= poor_quality) continue;
    if (std::min(quality(a, d, c), quality(d, b, c)) < least_gain * before) continue;
    const Vec3 old_f = cross(a, b, c), old_g = cross(b, a, d);
    const Vec3 new_f = cross(a, d, c), new_g = cross(d, b, c);
    const Vec3 mean = (old_f + old_g).normalized();
    const auto agrees = [&](const Vec3& n) { return n.dot(mean) >= flat * n.norm(); };
    if (!agrees(old_f) || !agrees(old_g) || !agrees(new_f) || !agrees(new_g)) continue;
    if (!(new_f.squaredNorm() > 0.0) || !(new_g.squaredNorm() > 0.0)) continue;
    if (!surface.can_flip(h)) continue;
    surface.flip(h);
    --flips_left;
    push_sides(h / 3);
    push_sides(back / 3);
  }
}

}  // namespace partuv::detail
