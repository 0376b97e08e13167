#include <algorithm>
#include <cmath>
#include <map>
#include <queue>

#include "rounded.hpp"
#include "segment/box_labels.hpp"
#include "segment/evaluator.hpp"
#include "segment/look_ahead.hpp"

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
    std::vector<int32_t> chart_of(surface.faces.size(), -1);
    for (size_t c = 0; c < charts.size(); ++c) {
      for (const int f : charts[c].faces) chart_of[f] = static_cast<int32_t>(c);
    }
    perimeter_.assign(charts.size(), 0.0);
    for (int c = 0; c < static_cast<int>(charts.size()); ++c) {
      for (const int f : charts[c].faces) {
        for (int k = 0; k < 3; ++k) {
          const int h = surface.opposite[f][k], beyond = h < 0 ? -1 : chart_of[h / 3];
          if (beyond == c) continue;
          const double length = side_length(surface, 3 * f + k);
          perimeter_[c] += length;
          if (beyond >= 0) shared_[c][beyond] += length;
        }
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

/// Two neighbouring charts, to be united in the order of cost.
struct Pair {
  float cost;
  bool predicted;  ///< or else the cost is one that the pair's own will hardly fall below
  int32_t a, b;
  int32_t age_a, age_b;  ///< versions of the charts when the pair was made

  bool operator>(const Pair& other) const {
    if (cost != other.cost) return cost > other.cost;
    if (a != other.a) return a > other.a;
    return b > other.b;
  }
};

class Merger {
 public:
  Merger(Evaluator& evaluator, ChartSet& charts, std::vector<char> movable, double most_work_faces)
      : evaluator_(evaluator),
        charts_(charts),
        movable_(std::move(movable)),
        most_work_faces_(most_work_faces),
        graph_(evaluator.surface(), charts),
        age_(charts.size(), 0),
        ahead_(evaluator) {
    if (movable_.empty()) movable_.assign(charts.size(), 1);
    // Either the evaluator has made all these charts or it is new, so that what it knows of them
    // does not depend on what threads have tried ahead.
    for (const Chart& chart : charts) {
      predicted_.push_back(evaluator.known_prediction(chart.faces).value_or(1.0));
    }
  }

  void run() {
    for (int a = 0; a < static_cast<int>(charts_.size()); ++a) {
      for (const auto& [b, unused] : graph_.neighbours(a)) {
        if (a < b) offer(a, b);
      }
    }
    while (!queue_.empty() && !evaluator_.context().stopping()) {
      look_ahead();
      if (queue_.empty()) break;
      Pair pair = queue_.top();
      queue_.pop();
      // Counted by what is decided, not by what threads do ahead, so that it is the same for all.
      constexpr double flatten_cost = 5.0;  // of flattening a union, in predictions
      const std::vector<int32_t> faces = union_of(pair);
      work_faces_ += (pair.predicted ? flatten_cost : 1.0) * static_cast<double>(faces.size());
      if (work_faces_ > most_work_faces_) break;
      ahead_.bridge(key_of(pair));
      if (pair.predicted) {
        unite(pair, faces);
        continue;
      }
      const double predicted = evaluator_.predicted(faces);
      if (predicted > evaluator_.limit()) continue;
      pair.cost = rounded(predicted + separateness(pair.a, pair.b));
      pair.predicted = true;
      queue_.push(pair);
    }
    std::erase_if(charts_, [](const Chart& chart) { return chart.faces.empty(); });
  }

 private:
  std::vector<int32_t> union_of(const Pair& pair) const {
    return united(charts_[pair.a].faces, charts_[pair.b].faces);
  }

  /// Where the prediction hardly tells (developable unions), the longer common boundary decides.
  double separateness(int a, int b) const { return 0.1 * (1.0 - graph_.closeness(a, b)); }

  /// Put a pair into the queue. Its own prediction is left for when it comes to the front: it will
  /// hardly be less than that of either chart.
  void offer(int one, int other) {
    // Charts that hardly touch would hang together by a thread.
    constexpr double least_closeness = 0.05;
    if (!movable_[one] && !movable_[other]) return;
    if (graph_.closeness(one, other) < least_closeness) return;
    const auto [a, b] = std::minmax(one, other);
    const double least = std::max(predicted_[a], predicted_[b]);
    queue_.push({rounded(least + separateness(a, b)), false, a, b, age_[a], age_[b]});
  }

  static LookAhead::Key key_of(const Pair& pair) {
    return {pair.a, pair.b, pair.age_a, pair.age_b, pair.predicted};
  }

  bool outdated(const Pair& pair) const {
    return age_[pair.a] != pair.age_a || age_[pair.b] != pair.age_b;
  }

  /// Drops outdated pairs from the front. If threads are free, they are given the pairs after the
  /// first one: where that unites, those with its charts were asked for nothing.
  void look_ahead() {
    constexpr size_t most_per_thread = 4;
    while (!queue_.empty() && outdated(queue_.top())) queue_.pop();
    if (queue_.size() < 2 || !ahead_.possible()) return;
    const size_t farthest = most_per_thread * static_cast<size_t>(evaluator_.context().threads());
    std::vector<Pair> next;
    std::vector<LookAhead::Question> questions;
    while (!queue_.empty() && next.size() < farthest) {
      const Pair pair = queue_.top();
      queue_.pop();
      if (outdated(pair)) continue;
      if (!next.empty() && !ahead_.begun(key_of(pair))) {
        questions.push_back({key_of(pair), pair.predicted, union_of(pair)});
      }
      next.push_back(pair);
    }
    for (const Pair& pair : next) queue_.push(pair);
    ahead_.expect(std::move(questions));
  }

  void unite(const Pair& pair, const std::vector<int32_t>& faces) {
    Chart &a = charts_[pair.a], &b = charts_[pair.b];
    // The full weld first: it leaves no seam inside the chart.
    std::optional<Chart> whole = evaluator_.chart(faces);
    if (!whole && evaluator_.options().partial_weld) whole = evaluator_.partly_welded(a, b);
    if (!whole) return;
    const bool first =
        area_of(evaluator_.surface(), a.faces) >= area_of(evaluator_.surface(), b.faces);
    whole->part = first ? a.part : b.part;
    a = std::move(*whole);
    b.faces.clear();
    predicted_[pair.a] = evaluator_.known_prediction(faces).value_or(1.0);
    movable_[pair.a] = 1;
    ++age_[pair.a];
    ++age_[pair.b];
    graph_.join(pair.a, pair.b);
    for (const auto& [c, unused] : graph_.neighbours(pair.a)) offer(pair.a, c);
  }

  Evaluator& evaluator_;
  ChartSet& charts_;
  std::vector<char> movable_;
  double most_work_faces_;
  ChartGraph graph_;
  std::vector<int32_t> age_;
  std::vector<double> predicted_;  ///< per chart, 1 where it is not known
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> queue_;
  double work_faces_ = 0.0;
  LookAhead ahead_;
};

}  // namespace

void merge_charts(Evaluator& evaluator, ChartSet& charts, std::vector<char> movable,
                  double most_work_faces) {
  Merger(evaluator, charts, std::move(movable), most_work_faces).run();
}

std::optional<ChartSet> merge_heuristic(Evaluator& evaluator, const std::vector<int32_t>& faces,
                                        int most_charts) {
  const Surface& s = evaluator.surface();
  const std::array<std::vector<int32_t>, 6> by_label = box_labels(s, evaluator.normals(), faces);
  std::vector<std::vector<int32_t>> regions;
  for (const auto& label : by_label) {
    for (auto& region : connected_parts(s, label)) regions.push_back(std::move(region));
  }
  if (regions.size() > 8 * static_cast<size_t>(evaluator.options().most_normal_charts)) {
    return std::nullopt;
  }
  ChartSet charts(regions.size());
  const bool flat = parallel_all(evaluator.context(), static_cast<int>(regions.size()), [&](int i) {
    std::optional<Chart> chart = evaluator.chart(regions[i]);
    if (chart) charts[i] = std::move(*chart);
    return chart.has_value();
  });
  if (!flat) return std::nullopt;
  merge_charts(evaluator, charts);
  if (static_cast<int>(charts.size()) > most_charts) return std::nullopt;
  return charts;
}

}  // namespace partuv
