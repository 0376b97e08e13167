#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <queue>

#include "segment/evaluator.hpp"

namespace partuv {
namespace {

std::vector<int32_t> united(const std::vector<int32_t>& a, const std::vector<int32_t>& b) {
  std::vector<int32_t> both;
  both.reserve(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

double area_of(const Surface& surface, const std::vector<int32_t>& faces) {
  double twice = 0.0;
  for (const int f : faces) twice += face_cross(surface, f).norm();
  return 0.5 * twice;
}

/// Charts as a graph: who shares how much boundary with whom.
class ChartGraph {
 public:
  ChartGraph(const Surface& surface, const ChartSet& charts) : shared_(charts.size()) {
    std::map<int32_t, int32_t> chart_of;
    for (size_t c = 0; c < charts.size(); ++c) {
      for (int f : charts[c].faces) chart_of.emplace_hint(chart_of.end(), f, static_cast<int>(c));
    }
    perimeter_.assign(charts.size(), 0.0);
    for (const auto& [f, c] : chart_of) {
      for (int k = 0; k < 3; ++k) {
        const Triangle& t = surface.faces[f];
        const double length = (surface.positions[t[(k + 1) % 3]] - surface.positions[t[k]]).norm();
        const int h = surface.opposite[f][k];
        const auto it = h < 0 ? chart_of.end() : chart_of.find(h / 3);
        if (it != chart_of.end() && it->second == c) continue;
        perimeter_[c] += length;
        if (it != chart_of.end()) shared_[c][it->second] += length;
      }
    }
  }

  const std::map<int32_t, double>& neighbours(int c) const { return shared_[c]; }

  /// Share of the shorter outline that two charts have in common.
  double closeness(int a, int b) const {
    const double shorter = std::min(perimeter_[a], perimeter_[b]);
    return shorter > 0.0 ? std::min(shared_[a].at(b) / shorter, 1.0) : 0.0;
  }

  /// Chart b becomes part of a.
  void join(int a, int b) {
    perimeter_[a] += perimeter_[b] - 2.0 * shared_[a].at(b);
    shared_[a].erase(b);
    for (const auto& [c, length] : shared_[b]) {
      shared_[c].erase(b);
      if (c == a) continue;
      shared_[a][c] += length;
      shared_[c][a] += length;
    }
    shared_[b].clear();
  }

 private:
  std::vector<std::map<int32_t, double>> shared_;
  std::vector<double> perimeter_;
};

struct Pair {
  double cost;
  int32_t a, b;
  int32_t age_a, age_b;  ///< versions of the charts when the pair was made
  bool operator>(const Pair& other) const {
    if (cost != other.cost) return cost > other.cost;
    if (a != other.a) return a > other.a;
    return b > other.b;
  }
};

}  // namespace

void merge_charts(Evaluator& evaluator, ChartSet& charts, std::vector<char> movable,
                  double most_work_faces) {
  if (movable.empty()) movable.assign(charts.size(), 1);
  ChartGraph graph(evaluator.surface(), charts);
  std::vector<int32_t> age(charts.size(), 0);
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> queue;
  // Charts that hardly touch would hang together by a thread.
  constexpr double least_closeness = 0.05;
  // Counted by what is decided, not by what the threads do ahead, so that it is the same for all.
  constexpr double flatten_cost = 5.0;  // of flattening a union, in predictions
  double work_faces = 0.0;
  const auto size_of = [&](int a, int b) {
    return static_cast<double>(charts[a].faces.size() + charts[b].faces.size());
  };
  // Predictions of new pairs are made side by side; the queue's order does not depend on it.
  auto offer = [&](std::vector<std::pair<int, int>> pairs) {
    std::erase_if(pairs, [&](const auto& p) {
      return (!movable[p.first] && !movable[p.second]) ||
             graph.closeness(p.first, p.second) < least_closeness;
    });
    size_t affordable = 0;
    while (affordable < pairs.size() && work_faces < most_work_faces) {
      work_faces += size_of(pairs[affordable].first, pairs[affordable].second);
      ++affordable;
    }
    pairs.resize(affordable);
    std::vector<double> predicted(pairs.size());
    parallel_for(evaluator.context(), static_cast<int>(pairs.size()), [&](int i) {
      const auto [a, b] = pairs[i];
      predicted[i] = evaluator.context().stopping()
                         ? hopeless
                         : evaluator.predicted(united(charts[a].faces, charts[b].faces));
    });
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (predicted[i] > evaluator.limit()) continue;
      const auto [a, b] = std::minmax(pairs[i].first, pairs[i].second);
      // Where the prediction hardly tells (developable unions), the longer common boundary decides.
      const double cost = predicted[i] + 0.1 * (1.0 - graph.closeness(a, b));
      queue.push({cost, a, b, age[a], age[b]});
    }
  };
  std::vector<std::pair<int, int>> pairs;
  for (size_t a = 0; a < charts.size(); ++a) {
    for (const auto& [b, unused] : graph.neighbours(static_cast<int>(a))) {
      if (static_cast<int>(a) < b) pairs.emplace_back(static_cast<int>(a), b);
    }
  }
  offer(std::move(pairs));
  auto outdated = [&](const Pair& p) { return age[p.a] != p.age_a || age[p.b] != p.age_b; };
  while (!queue.empty() && !evaluator.context().stopping()) {
    // The next few unions are flattened side by side; the evaluator remembers them. More than there
    // are threads, so that none waits long for the others: what fails, fails for good.
    const int free = evaluator.context().free_threads();
    const size_t ahead = free > 1 ? 2 * free : 1;
    std::vector<Pair> next;
    while (!queue.empty() && next.size() < ahead) {
      if (!outdated(queue.top())) next.push_back(queue.top());
      queue.pop();
    }
    parallel_for(evaluator.context(), static_cast<int>(next.size()), [&](int i) {
      evaluator.chart(united(charts[next[i].a].faces, charts[next[i].b].faces));
    });
    for (const Pair& pair : next) queue.push(pair);
    if (queue.empty()) break;
    const Pair pair = queue.top();
    queue.pop();
    work_faces += flatten_cost * size_of(pair.a, pair.b);
    if (work_faces > most_work_faces) break;
    // The full weld first: it leaves no seam inside the chart.
    std::optional<Chart> whole =
        evaluator.chart(united(charts[pair.a].faces, charts[pair.b].faces));
    if (!whole && evaluator.options().partial_weld) {
      whole = evaluator.partly_welded(charts[pair.a], charts[pair.b]);
    }
    if (!whole) continue;
    const double area_a = area_of(evaluator.surface(), charts[pair.a].faces);
    const double area_b = area_of(evaluator.surface(), charts[pair.b].faces);
    whole->part = area_a >= area_b ? charts[pair.a].part : charts[pair.b].part;
    charts[pair.a] = std::move(*whole);
    charts[pair.b].faces.clear();
    movable[pair.a] = 1;
    ++age[pair.a];
    ++age[pair.b];
    graph.join(pair.a, pair.b);
    pairs.clear();
    for (const auto& [c, unused] : graph.neighbours(pair.a)) pairs.emplace_back(pair.a, c);
    offer(std::move(pairs));
  }
  std::erase_if(charts, [](const Chart& chart) { return chart.faces.empty(); });
}

std::optional<ChartSet> merge_heuristic(Evaluator& evaluator, const std::vector<int32_t>& faces,
                                        int most_charts) {
  const Surface& s = evaluator.surface();
  // Axes of the box: principal axes of the area.
  Vec3 mean = Vec3::Zero();
  double area = 0.0;
  for (int f : faces) {
    const double a = face_cross(s, f).norm();
    const Triangle& t = s.faces[f];
    mean += a * (s.positions[t[0]] + s.positions[t[1]] + s.positions[t[2]]) / 3.0;
    area += a;
  }
  if (!(area > 0.0)) return std::nullopt;
  mean /= area;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (int f : faces) {
    const double a = face_cross(s, f).norm();
    for (int v : s.faces[f]) {
      const Vec3 d = s.positions[v] - mean;
      spread += a * d * d.transpose();
    }
  }
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  std::vector<std::vector<int32_t>> by_label(6);
  for (int f : faces) {
    const Vec3 n = axes.transpose() * face_cross(s, f);
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    by_label[2 * axis + (n[axis] < 0.0)].push_back(f);
  }
  std::vector<std::vector<int32_t>> regions;
  for (const auto& label : by_label) {
    for (auto& region : connected_parts(s, label)) regions.push_back(std::move(region));
  }
  if (regions.size() > 8 * static_cast<size_t>(evaluator.options().most_normal_charts)) {
    return std::nullopt;
  }
  ChartSet charts(regions.size());
  std::atomic<bool> all{true};
  parallel_for(evaluator.context(), static_cast<int>(regions.size()), [&](int i) {
    std::optional<Chart> chart = all ? evaluator.chart(regions[i]) : std::nullopt;
    if (chart) {
      charts[i] = std::move(*chart);
    } else {
      all = false;
    }
  });
  if (!all || evaluator.context().cancelled()) return std::nullopt;
  merge_charts(evaluator, charts);
  if (static_cast<int>(charts.size()) > most_charts) return std::nullopt;
  return charts;
}

}  // namespace partuv
