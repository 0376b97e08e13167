#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "partuv/lift.hpp"
#include "segment/lift_regions.hpp"
#include "segment/minimum_cut.hpp"

namespace partuv {
namespace {

class Straightener {
 public:
  Straightener(const Surface& surface, const SideWeights& sides, double band,
               std::vector<int32_t>& label, const Context& context)
      : surface_(surface), sides_(sides), band_(band), label_(label), context_(context) {}

  void run() {
    // The second round moves the junctions on, which the first one holds.
    constexpr int rounds = 2;
    for (int round = 0; round < rounds && !context_.cancelled(); ++round) {
      find_bands();
      cut_bands();
    }
    smooth_teeth();
  }

 private:
  struct Pair {
    int32_t low, high;  ///< labels, low < high
    bool operator<(const Pair& other) const {
      return low != other.low ? low < other.low : high < other.high;
    }
    bool operator==(const Pair& other) const { return low == other.low && high == other.high; }
  };

  std::vector<uint8_t> faces_on_creases() const;
  void measure_distances();
  std::vector<double> measure_depths() const;
  void find_bands();
  void cut_bands();
  void smooth_teeth();
  void cut(const Pair& pair, const std::vector<int32_t>& faces, MinimumCut& graph,
           std::vector<int32_t>& node, std::vector<int32_t>& wanted) const;
  Vec3 centre(int f) const {
    const Triangle& t = surface_.faces[f];
    return (surface_.positions[t[0]] + surface_.positions[t[1]] + surface_.positions[t[2]]) / 3.0;
  }

  const Surface& surface_;
  const SideWeights& sides_;
  double band_;
  std::vector<int32_t>& label_;
  const Context& context_;
  std::vector<Pair> nearest_;     ///< for each face the boundary it may move with, or {-1, -1}
  std::vector<double> distance_;  ///< from the nearest boundary
  std::vector<Vec3> origin_;      ///< where on that boundary
};

/// Faces at a boundary that runs along a crease there, and on along it at both ends.
std::vector<uint8_t> Straightener::faces_on_creases() const {
  const auto on_crease = [&](int f, int s) {
    const int h = surface_.opposite[f][s];
    return h >= 0 && label_[h / 3] != label_[f] && sides_.crease[f][s];
  };
  // Every side of a crease counts once from each of its two faces.
  std::vector<uint8_t> sides_at(surface_.positions.size(), 0);
  for (int f = 0; f < surface_.face_count(); ++f) {
    for (int s = 0; s < 3; ++s) {
      if (!on_crease(f, s)) continue;
      for (const int v : {surface_.faces[f][s], surface_.faces[f][(s + 1) % 3]}) {
        if (sides_at[v] < 4) ++sides_at[v];
      }
    }
  }
  std::vector<uint8_t> held(surface_.faces.size(), 0);
  for (int f = 0; f < surface_.face_count(); ++f) {
    const Triangle& t = surface_.faces[f];
    for (int s = 0; s < 3; ++s) {
      if (on_crease(f, s) && sides_at[t[s]] == 4 && sides_at[t[(s + 1) % 3]] == 4) held[f] = 1;
    }
  }
  return held;
}

/// Distances from the boundaries, as far as the band reaches, with the pair of labels that meet
/// there.
void Straightener::measure_distances() {
  const int faces = surface_.face_count();
  nearest_.assign(faces, {-1, -1});
  origin_.resize(faces);
  distance_.assign(faces, std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (int f = 0; f < faces; ++f) {
    const Triangle& t = surface_.faces[f];
    for (int s = 0; s < 3; ++s) {
      const int h = surface_.opposite[f][s];
      if (h < 0 || label_[h / 3] == label_[f]) continue;
      const Vec3 middle = 0.5 * (surface_.positions[t[s]] + surface_.positions[t[(s + 1) % 3]]);
      const double d = (centre(f) - middle).norm();
      if (!(d < distance_[f])) continue;
      distance_[f] = d;
      origin_[f] = middle;
      nearest_[f] = {std::min(label_[f], label_[h / 3]), std::max(label_[f], label_[h / 3])};
    }
    if (nearest_[f].low >= 0) queue.emplace(distance_[f], f);
  }
  while (!queue.empty()) {
    const auto [d, f] = queue.top();
    queue.pop();
    if (d > distance_[f]) continue;
    for (const int h : surface_.opposite[f]) {
      if (h < 0 || label_[h / 3] != label_[f]) continue;
      const int g = h / 3;
      const double farther = d + (centre(g) - centre(f)).norm();
      if (farther > band_ || farther >= distance_[g]) continue;
      distance_[g] = farther;
      origin_[g] = origin_[f];
      nearest_[g] = nearest_[f];
      queue.emplace(farther, g);
    }
  }
}

/// How far it is from each boundary to the middle of the region, along the way up from face f;
/// infinite where that is beyond the band.
std::vector<double> Straightener::measure_depths() const {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  // Fronts from two sides meet where their origins are about twice the distance apart.
  constexpr double apart = 0.8;
  // What a single face holds, a tooth of the boundary, has no middle.
  constexpr double tooth_heights = 0.6;
  std::vector<int32_t> order;
  for (int f = 0; f < surface_.face_count(); ++f) {
    if (nearest_[f].low >= 0) order.push_back(f);
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return distance_[a] != distance_[b] ? distance_[a] > distance_[b] : a < b;
  });
  std::vector<double> depth(surface_.faces.size(), infinite);
  const auto in_tooth = [&](int f) {
    return distance_[f] < tooth_heights * std::sqrt(face_cross(surface_, f).norm());
  };
  for (const int f : order) {
    double steepest = 0.0, above = in_tooth(f) ? infinite : distance_[f];
    bool in_the_middle = false;
    for (const int h : surface_.opposite[f]) {
      if (h < 0 || label_[h / 3] != label_[f]) continue;
      const int g = h / 3;
      if (nearest_[g].low < 0) {
        steepest = infinite;
        above = infinite;
        continue;
      }
      in_the_middle |= !in_tooth(f) && !in_tooth(g) &&
                       (origin_[f] - origin_[g]).norm() > apart * (distance_[f] + distance_[g]);
      const double slope = (distance_[g] - distance_[f]) / (centre(g) - centre(f)).norm();
      if (slope > steepest) {
        steepest = slope;
        above = depth[g];
      }
    }
    depth[f] = in_the_middle ? distance_[f] : above;
  }
  return depth;
}

/// Leave in the bands what may change its label: faces nearer to the boundary than to the middle of
/// their region, and not on a boundary that follows a crease.
void Straightener::find_bands() {
  measure_distances();
  const std::vector<double> depth = measure_depths();
  const std::vector<uint8_t> held = faces_on_creases();
  std::vector<uint8_t> has_core(1 + *std::max_element(label_.begin(), label_.end()), 0);
  for (int f = 0; f < surface_.face_count(); ++f) {
    if (nearest_[f].low < 0 || held[f] || distance_[f] >= 0.5 * depth[f]) {
      nearest_[f] = {-1, -1};
      has_core[label_[f]] = 1;
    }
  }
  for (int f = 0; f < surface_.face_count(); ++f) {
    if (!has_core[label_[f]]) nearest_[f] = {-1, -1};
  }
}

void Straightener::cut(const Pair& pair, const std::vector<int32_t>& faces, MinimumCut& graph,
                       std::vector<int32_t>& node, std::vector<int32_t>& wanted) const {
  for (size_t i = 0; i < faces.size(); ++i) {
    node[faces[i]] = MinimumCut::first_node + static_cast<int>(i);
  }
  graph.reset(static_cast<int>(faces.size()));
  constexpr double steps_per_band = 1 << 16;
  // What it costs to move a boundary over an area, per distance: waves longer than about three
  // bands stay, and round regions do not shrink to their middle.
  constexpr double inertia = 2.0;
  const auto steps = [&](double length) {
    return static_cast<int32_t>(std::min(length / band_ * steps_per_band, 1e8));
  };
  for (const int f : faces) {
    const double area = 0.5 * face_cross(surface_, f).norm();
    const int32_t stay = steps(inertia * area * distance_[f] / (band_ * band_));
    if (stay > 0 && label_[f] == pair.low) {
      graph.add_edge(MinimumCut::source, node[f], stay);
    } else if (stay > 0) {
      graph.add_edge(node[f], MinimumCut::sink, stay);
    }
    for (int s = 0; s < 3; ++s) {
      const int h = surface_.opposite[f][s];
      if (h < 0) continue;
      const int g = h / 3;
      const bool inside = nearest_[g] == pair;
      if (inside && g < f) continue;
      const int32_t capacity = 1 + steps(sides_.cost[f][s]);
      if (inside) {
        graph.add_edge(node[f], node[g], capacity);
      } else if (label_[g] == pair.low) {
        graph.add_edge(MinimumCut::source, node[f], capacity);
      } else if (label_[g] == pair.high) {
        graph.add_edge(node[f], MinimumCut::sink, capacity);
      }
    }
  }
  graph.solve(context_);
  for (const int f : faces) {
    wanted[f] = graph.on_source_side(node[f]) ? pair.low : pair.high;
  }
}

void Straightener::cut_bands() {
  std::vector<int32_t> order;
  for (int f = 0; f < surface_.face_count(); ++f) {
    if (nearest_[f].low >= 0) order.push_back(f);
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return nearest_[a] == nearest_[b] ? a < b : nearest_[a] < nearest_[b];
  });
  std::vector<size_t> begin;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || !(nearest_[order[i]] == nearest_[order[i - 1]])) begin.push_back(i);
  }
  begin.push_back(order.size());
  // The bands share no face, so that they can be cut side by side.
  std::vector<int32_t> node(surface_.face_count(), -1), wanted = label_;
  parallel_for(context_, static_cast<int>(begin.size()) - 1, [&](int i) {
    MinimumCut graph;
    const std::vector<int32_t> faces(order.begin() + begin[i], order.begin() + begin[i + 1]);
    cut(nearest_[faces[0]], faces, graph, node, wanted);
  });
  detail::Regions(surface_, label_).change_to(wanted, order);
}

/// What the bands could not reach: single faces that stick out, at junctions and in narrow regions.
void Straightener::smooth_teeth() {
  std::vector<int32_t> boundary;
  for (int f = 0; f < surface_.face_count(); ++f) {
    for (const int h : surface_.opposite[f]) {
      if (h < 0 || label_[h / 3] == label_[f]) continue;
      boundary.push_back(f);
      break;
    }
  }
  detail::Regions(surface_, label_).descend(boundary, [&](int f, int32_t other) {
    double saved = 0.0;
    for (int s = 0; s < 3; ++s) {
      const int h = surface_.opposite[f][s];
      if (h < 0) continue;
      const int32_t beyond = label_[h / 3];
      if (beyond != label_[f] && sides_.crease[f][s]) return -1.0;
      if (beyond != label_[f]) saved += sides_.cost[f][s];
      if (beyond != other) saved -= sides_.cost[f][s];
    }
    return saved;
  });
}

}  // namespace

void straighten_labels(const Surface& surface, const SideWeights& weights, double band,
                       std::vector<int32_t>& label, const Context& context) {
  if (!(band > 0.0) || surface.face_count() == 0) return;
  Straightener(surface, weights, band, label, context).run();
}

}  // namespace partuv
