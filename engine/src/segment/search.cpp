#include "partuv/search.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "segment/evaluator.hpp"

namespace partuv {
namespace {

constexpr int unbounded = std::numeric_limits<int>::max();

/// Levels of the tree that may split up disconnected components before each component is searched
/// on its own (the paper's "predefined recursion depth").
constexpr int most_mixed_levels = 12;

class TreeSearch {
 public:
  TreeSearch(Evaluator& evaluator, const PartTree& tree, Context& context)
      : evaluator_(evaluator), tree_(tree), context_(context) {
    place_.resize(tree.order.size());
    for (size_t i = 0; i < tree.order.size(); ++i) place_[tree.order[i]] = static_cast<int>(i);
  }

  /// Algorithm 1 of the paper: the fewest charts found for a node, none if they exceed the budget.
  std::optional<ChartSet> search(int node, int budget, int mixed_levels = 0) {
    if (budget < 1) return std::nullopt;
    if (tree_.root() - node < evaluator_.options().fixed_parts - 1 && !tree_.is_leaf(node)) {
      return children(node, budget, mixed_levels);
    }
    const std::vector<int32_t> faces = faces_of(node);
    if (faces.size() == 1) {
      settle(budget, faces.size());
      return ChartSet{single(faces, node)};
    }
    const auto parts = connected_parts(evaluator_.surface(), faces);
    if (context_.stopping()) {
      settle(budget, faces.size());
      return untried(parts, node);
    }
    if (parts.size() > 1) {
      const bool mixed = splits_a_component(node, parts);
      if (mixed && mixed_levels >= most_mixed_levels) return each_component(parts, budget, node);
      return children(node, budget, mixed_levels + mixed);
    }
    std::optional<ChartSet> best = heuristics(faces, budget, node);
    if (!best) return children(node, budget, mixed_levels);
    settle(budget, faces.size());
    // Look for a better combination below; only worth it where two subtrees could do better.
    const int count = static_cast<int>(best->size());
    if (evaluator_.options().recursion && count > 2) {
      std::optional<ChartSet> combined = children(node, std::min(budget, count - 1), mixed_levels);
      if (combined && combined->size() < best->size()) best = std::move(combined);
    }
    return best;
  }

 private:
  std::vector<int32_t> faces_of(int node) const {
    std::vector<int32_t> faces(tree_.order.begin() + tree_.begin[node],
                               tree_.order.begin() + tree_.end[node]);
    std::sort(faces.begin(), faces.end());
    return faces;
  }

  /// True if the two children of a node share a connected component of it.
  bool splits_a_component(int node, const std::vector<std::vector<int32_t>>& parts) const {
    const int middle = tree_.end[tree_.left[node - tree_.face_count]];
    for (const auto& part : parts) {
      const bool first = place_[part.front()] < middle;
      for (int f : part) {
        if ((place_[f] < middle) != first) return true;
      }
    }
    return false;
  }

  /// Every component by itself. Without a bound they are independent and run side by side.
  std::optional<ChartSet> each_component(const std::vector<std::vector<int32_t>>& parts, int budget,
                                         int node) {
    const int count = static_cast<int>(parts.size());
    std::vector<std::optional<ChartSet>> found(count);
    ChartSet charts;
    if (budget == unbounded) {
      parallel_for(context_, count, [&](int i) { found[i] = component(parts[i], budget, node); });
    }
    for (int i = 0; i < count; ++i) {
      if (budget != unbounded) {
        found[i] = component(parts[i], budget - static_cast<int>(charts.size()), node);
      }
      if (!found[i]) return std::nullopt;
      charts.insert(charts.end(), found[i]->begin(), found[i]->end());
    }
    return charts;
  }

  /// A component by the heuristics, or else by those for its halves by normals.
  std::optional<ChartSet> component(const std::vector<int32_t>& faces, int budget, int node) {
    ChartSet charts;
    std::vector<std::vector<int32_t>> open{faces};
    while (!open.empty()) {
      const std::vector<int32_t> part = std::move(open.back());
      open.pop_back();
      const int left = budget == unbounded ? unbounded : budget - static_cast<int>(charts.size());
      if (left < 1) return std::nullopt;
      std::optional<ChartSet> found = heuristics(part, left, node);
      if (!found && context_.stopping()) found = ChartSet{single(part, node)};
      if (!found) {
        for (auto& half : normal_halves(evaluator_.surface(), part, context_)) {
          open.push_back(std::move(half));
        }
        continue;
      }
      settle(budget, part.size());
      charts.insert(charts.end(), found->begin(), found->end());
    }
    return charts;
  }

  static Chart single(const std::vector<int32_t>& faces, int node) {
    Chart chart;
    chart.faces = faces;
    chart.part = node;
    return chart;
  }

  static ChartSet untried(const std::vector<std::vector<int32_t>>& parts, int node) {
    ChartSet charts;
    for (const auto& part : parts) charts.push_back(single(part, node));
    return charts;
  }

  std::optional<ChartSet> heuristics(const std::vector<int32_t>& faces, int budget, int node) {
    const SearchOptions& options = evaluator_.options();
    const int most = options.most_normal_charts;
    std::optional<ChartSet> best = normal_heuristic(evaluator_, faces, std::min(budget, most));
    const int fewer = best ? static_cast<int>(best->size()) - options.least_merge_gain : budget;
    // A single chart, fully welded, is what Normal tries first.
    const int fewest = options.partial_weld ? 1 : 2;
    // Merge may stay below the budget where Normal, cut off by it, would not have.
    if (options.merge_heuristic && (best ? fewer >= fewest : budget < most)) {
      if (auto merged = merge_heuristic(evaluator_, faces, fewer)) best = std::move(merged);
    }
    if (best) {
      for (Chart& chart : *best) chart.part = node;
    }
    return best;
  }

  /// Both children within a common budget. Without a bound they are independent and may run side by
  /// side; with one the right child gets exactly what the left one leaves.
  std::optional<ChartSet> children(int node, int budget, int mixed_levels) {
    const int left = tree_.left[node - tree_.face_count];
    const int right = tree_.right[node - tree_.face_count];
    std::optional<ChartSet> l, r;
    if (budget == unbounded) {
      parallel_for(context_, 2, [&](int i) {
        (i == 0 ? l : r) = search(i == 0 ? left : right, unbounded, mixed_levels);
      });
    } else {
      l = search(left, budget - 1, mixed_levels);
      if (!l) return std::nullopt;
      r = search(right, budget - static_cast<int>(l->size()), mixed_levels);
    }
    if (!l || !r) return std::nullopt;
    l->insert(l->end(), std::make_move_iterator(r->begin()), std::make_move_iterator(r->end()));
    return l;
  }

  /// Faces of unbounded searches are settled once: they carry the progress.
  void settle(int budget, size_t faces) {
    if (budget != unbounded) return;
    const int64_t done = settled_ += static_cast<int64_t>(faces);
    context_.advance(static_cast<double>(done) / tree_.face_count);
  }

  Evaluator& evaluator_;
  const PartTree& tree_;
  std::vector<int32_t> place_;  ///< of each face in the order of the tree
  Context& context_;
  std::atomic<int64_t> settled_{0};
};

}  // namespace

ChartSet search_charts(const Surface& surface, const PartTree& tree,
                       const std::vector<double>& weight, const SearchOptions& options,
                       Context& context) {
  Evaluator evaluator(surface, weight, options, context);
  TreeSearch search(evaluator, tree, context);
  ChartSet charts = search.search(tree.root(), unbounded).value_or(ChartSet{});
  if (options.final_merge) merge_charts(evaluator, charts);
  // Part numbers in order of the tree's nodes.
  std::vector<int32_t> nodes;
  for (const Chart& chart : charts) nodes.push_back(chart.part);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  for (Chart& chart : charts) {
    chart.part = static_cast<int32_t>(std::lower_bound(nodes.begin(), nodes.end(), chart.part) -
                                      nodes.begin());
  }
  return charts;
}

}  // namespace partuv
