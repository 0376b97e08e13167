#include "partuv/cut.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

#include "disjoint_sets.hpp"
#include "rounded.hpp"
#include "tree/steady_normals.hpp"

namespace partuv {
namespace {

constexpr double pi = std::numbers::pi;

/// Vertex graph of a piece with the price of cutting each edge; boundary edges cost nothing.
class CutGraph {
 public:
  explicit CutGraph(const Piece& piece) : surface_(piece.surface) {
    const Surface& s = surface_;
    price_.assign(3 * s.faces.size(), 0.0);
    const std::vector<Vec3> normal = steady_normals(s);
    std::vector<int32_t> degree(s.positions.size() + 1, 0);
    for (int h = 0; h < side_count(); ++h) {
      const int other = s.opposite[h / 3][h % 3];
      if (other > h) continue;
      if (other >= 0) {
        // Rounded, so that sums are exact, and paths that are alike by symmetry cost the same.
        price_[h] = price_[other] =
            rounded(side_length(s, h) * reluctance(normal[h / 3], normal[other / 3], h));
      }
      ++degree[from(h)];
      ++degree[to(h)];
    }
    start_.assign(degree.size(), 0);
    for (size_t v = 0; v + 1 < degree.size(); ++v) start_[v + 1] = start_[v] + degree[v];
    sides_.resize(start_.back());
    std::vector<int32_t> fill(start_.begin(), start_.end() - 1);
    for (int h = 0; h < side_count(); ++h) {
      if (s.opposite[h / 3][h % 3] > h) continue;
      sides_[fill[from(h)]++] = h;
      sides_[fill[to(h)]++] = h;
    }
  }

  int side_count() const { return static_cast<int>(3 * surface_.faces.size()); }
  int from(int h) const { return surface_.faces[h / 3][h % 3]; }
  int to(int h) const { return surface_.faces[h / 3][(h % 3 + 1) % 3]; }
  int opposite(int h) const { return surface_.opposite[h / 3][h % 3]; }
  double price(int h) const { return price_[h]; }
  int first(int v) const { return start_[v]; }
  int last(int v) const { return start_[v + 1]; }
  int side(int i) const { return sides_[i]; }
  int other_end(int h, int v) const { return from(h) == v ? to(h) : from(h); }

 private:
  /// 1 on smooth ground, down to 0.3 on convex and 0.15 on concave creases of 45 degrees.
  double reluctance(const Vec3& a, const Vec3& b, int h) const {
    constexpr double crease = 0.76536686473017954;  // chord of 45 degrees
    const double bend = std::min((a - b).norm() / crease, 1.0);
    const int apex = surface_.faces[h / 3][(h % 3 + 2) % 3];
    const bool concave = b.dot(surface_.positions[apex] - surface_.positions[from(h)]) > 0.0;
    return 1.0 - bend * (concave ? 0.85 : 0.7);
  }

  const Surface& surface_;
  std::vector<double> price_;
  std::vector<int32_t> start_, sides_;
};

/// Grows a cut: shortest paths from everything that is already cut.
class Grower {
 public:
  Grower(const Piece& piece, const CutGraph& graph)
      : piece_(piece),
        graph_(graph),
        distance_(piece.surface.positions.size(), unreached),
        arrival_(piece.surface.positions.size(), -1),
        loop_of_(piece.surface.positions.size(), -1),
        is_source_(piece.surface.positions.size(), 0) {
    for (size_t l = 0; l < piece.loops.size(); ++l) {
      for (int h : piece.loops[l]) loop_of_[graph.from(h)] = static_cast<int32_t>(l);
    }
  }

  /// Make a vertex, and the loop it lies on, part of the cut.
  void add_source(int v) {
    if (is_source_[v]) return;
    start_from(v);
    if (loop_of_[v] < 0) return;
    for (int h : piece_.loops[loop_of_[v]]) {
      if (!is_source_[graph_.from(h)]) start_from(graph_.from(h));
    }
  }

  /// Walk to the nearest vertex with a wanted mark; -1 if none can be reached.
  int nearest(const std::vector<char>& wanted) {
    while (!queue_.empty()) {
      const auto [d, v] = queue_.top();
      if (d > distance_[v]) {
        queue_.pop();
        continue;
      }
      if (wanted[v] && !is_source_[v]) return v;
      queue_.pop();
      relax(v);
    }
    return -1;
  }

  /// The vertex farthest from the sources.
  int farthest() {
    nearest(std::vector<char>(distance_.size(), 0));
    int best = 0;
    for (size_t v = 0; v < distance_.size(); ++v) {
      if (distance_[v] < unreached && distance_[v] > distance_[best]) best = static_cast<int>(v);
    }
    return best;
  }

  /// Cut along the path that leads to v, and grow from it too.
  void cut_path(int v, CutSides& cuts) {
    std::vector<int32_t> path{static_cast<int32_t>(v)};
    for (int h = arrival_[v]; h >= 0; h = arrival_[v]) {
      const int other = graph_.opposite(h);
      if (other >= 0) cuts[h] = cuts[other] = 1;
      v = graph_.other_end(h, v);
      path.push_back(v);
    }
    for (int w : path) add_source(w);
  }

  /// The tree of shortest paths as it stands: for each vertex the side by which it was reached.
  const std::vector<int32_t>& arrivals() const { return arrival_; }
  double distance(int v) const { return distance_[v]; }

 private:
  static constexpr double unreached = 1e300;

  void start_from(int v) {
    is_source_[v] = 1;
    push(v, 0.0, -1);
  }

  void push(int v, double d, int by) {
    distance_[v] = d;
    arrival_[v] = by;
    queue_.emplace(d, v);
  }

  void relax(int v) {
    for (int i = graph_.first(v); i < graph_.last(v); ++i) {
      const int h = graph_.side(i), w = graph_.other_end(h, v);
      const double d = distance_[v] + graph_.price(h);
      if (d < distance_[w]) push(w, d, h);
    }
  }

  using Entry = std::pair<double, int>;
  const Piece& piece_;
  const CutGraph& graph_;
  std::vector<double> distance_;
  std::vector<int32_t> arrival_, loop_of_;
  std::vector<char> is_source_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

/// Cut every handle: sides neither in the tree of shortest paths nor crossed by the dual tree of
/// the farthest ones close a loop around a handle. Returns the vertices along the cuts.
std::vector<int32_t> cut_handles(const CutGraph& graph, Grower& tree, int face_count,
                                 CutSides& cuts) {
  tree.farthest();  // completes the tree of shortest paths
  std::vector<char> in_tree(graph.side_count(), 0);
  for (int h : tree.arrivals()) {
    if (h < 0) continue;
    in_tree[h] = 1;
    if (graph.opposite(h) >= 0) in_tree[graph.opposite(h)] = 1;
  }
  std::vector<std::pair<double, int32_t>> crossing;
  for (int h = 0; h < graph.side_count(); ++h) {
    if (graph.opposite(h) < h || in_tree[h]) continue;
    crossing.emplace_back(
        -(tree.distance(graph.from(h)) + tree.distance(graph.to(h)) + graph.price(h)), h);
  }
  std::sort(crossing.begin(), crossing.end());
  DisjointSets crossed(face_count);
  std::vector<int32_t> left_over;
  for (const auto& [unused, h] : crossing) {
    if (!crossed.join(h / 3, graph.opposite(h) / 3)) left_over.push_back(h);
  }
  const std::vector<int32_t>& arrivals = tree.arrivals();
  std::vector<int32_t> touched;
  for (int h : left_over) {
    cuts[h] = cuts[graph.opposite(h)] = 1;
    for (int v : {graph.from(h), graph.to(h)}) {
      touched.push_back(v);
      for (int side = arrivals[v]; side >= 0; side = arrivals[v]) {
        if (graph.opposite(side) >= 0) cuts[side] = cuts[graph.opposite(side)] = 1;
        v = graph.other_end(side, v);
        touched.push_back(v);
      }
    }
  }
  return touched;
}

/// How far a loop turns, seen from the piece: 2 pi around a disk, -2 pi around a hole of a sheet,
/// 0 at the end of a tube.
double turning(const Surface& s, const std::vector<int32_t>& loop,
               const std::vector<double>& angle_sum) {
  double sum = 0.0;
  for (int h : loop) sum += pi - angle_sum[s.faces[h / 3][h % 3]];
  return sum;
}

}  // namespace

CutSides find_cuts(const Piece& piece, const CutOptions& options) {
  const Surface& s = piece.surface;
  CutSides cuts(3 * s.faces.size(), 0);
  std::vector<char> wanted(s.positions.size(), 0);
  bool any_wanted = false;
  for (int v : options.terminals) {
    wanted[v] = 1;
    any_wanted = true;
  }
  if (options.join_tubes && piece.loops.size() > 1) {
    const double area = surface_area(s);
    const std::vector<double> angle_sum = angle_sums(piece);
    for (size_t l = 1; l < piece.loops.size(); ++l) {
      const bool tiny = loop_length(s, piece.loops[l]) < 0.05 * std::sqrt(area);
      if (tiny || turning(s, piece.loops[l], angle_sum) < -1.6 * pi) continue;
      for (int h : piece.loops[l]) wanted[s.faces[h / 3][h % 3]] = 1;
      any_wanted = true;
    }
  }
  const bool closed = piece.loops.empty();
  if (!closed && piece.genus() == 0 && !any_wanted) return cuts;

  const CutGraph graph(piece);
  int seed = 0;
  if (!closed) {
    seed = graph.from(piece.loops.front().front());
  } else if (!options.terminals.empty()) {
    seed = options.terminals.front();
  }
  std::vector<int32_t> sources{seed};
  if (piece.genus() > 0 || (closed && options.terminals.size() < 2)) {
    Grower tree(piece, graph);
    tree.add_source(seed);
    if (piece.genus() > 0) {
      sources = cut_handles(graph, tree, s.face_count(), cuts);
    } else {
      wanted[tree.farthest()] = 1;
    }
  }
  Grower grower(piece, graph);
  grower.add_source(seed);
  for (int v : sources) grower.add_source(v);
  for (int v = grower.nearest(wanted); v >= 0; v = grower.nearest(wanted)) grower.cut_path(v, cuts);
  return cuts;
}

}  // namespace partuv
