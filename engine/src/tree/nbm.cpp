#include <algorithm>
#include <numeric>
#include <utility>

#include "partuv/tree_nbm.hpp"
#include "rounded.hpp"
#include "tree/contraction.hpp"
#include "tree/merges.hpp"

namespace partuv {

namespace {

/// The score of an edge when it was pushed. As regions grow, the score of an edge only falls and
/// the numbers of its nodes only rise, so an old entry never comes later than its edge is due.
struct Entry {
  float score;
  int32_t low, high;  ///< nodes
  int32_t edge;
};

/// The order of a heap with the largest score, then the smallest nodes, on top.
struct Later {
  bool operator()(const Entry& a, const Entry& b) const {
    if (a.score != b.score) return a.score < b.score;
    if (a.low != b.low) return a.low > b.low;
    return a.high > b.high;
  }
};

class BoundaryMerger {
 public:
  BoundaryMerger(const std::vector<DualEdge>& edges, std::vector<double> area, Merges& merges)
      : graph_(static_cast<int>(area.size()), edges),
        area_(std::move(area)),
        merges_(merges),
        node_(area_.size()),
        pushed_(graph_.edge_count()) {
    std::iota(node_.begin(), node_.end(), 0);
    heap_.reserve(2 * graph_.edge_count());
    for (int e = 0; e < graph_.edge_count(); ++e) {
      heap_.push_back(entry(e));
      pushed_[e] = heap_.back().score;
    }
    std::make_heap(heap_.begin(), heap_.end(), Later());
  }

  void run(const Context& context) {
    constexpr uint32_t steps_between_checks = 4096;
    for (uint32_t step = 1; !heap_.empty(); ++step) {
      if (step % steps_between_checks == 0 && context.stopping()) {
        return contract_in_rounds(graph_, context, [&](int e) { join(e); });
      }
      std::pop_heap(heap_.begin(), heap_.end(), Later());
      const Entry top = heap_.back();
      heap_.pop_back();
      if (!graph_.alive(top.edge) || pushed_[top.edge] != top.score) continue;
      const Entry now = entry(top.edge);
      if (Later()(now, top)) {
        push(now);
      } else {
        merge(top.edge);
      }
    }
  }

 private:
  Entry entry(int e) const {
    const auto [a, b] = graph_.edge(e).slot;
    const double score = graph_.edge(e).weight * (1.0 / area_[a] + 1.0 / area_[b]);
    const auto [low, high] = std::minmax(node_[a], node_[b]);
    return {rounded(score), low, high, e};
  }

  void push(const Entry& entry) {
    pushed_[entry.edge] = entry.score;
    heap_.push_back(entry);
    std::push_heap(heap_.begin(), heap_.end(), Later());
  }

  void merge(int e) {
    join(e);
    graph_.contract(e, [&](int changed, bool folded) {
      if (folded) push(entry(changed));
    });
  }

  // Both slots become the new region: which one survives the contraction is the graph's business.
  void join(int e) {
    const auto [a, b] = graph_.edge(e).slot;
    node_[a] = node_[b] = merges_.join(node_[a], node_[b]);
    area_[a] = area_[b] = area_[a] + area_[b];
  }

  ContractionGraph graph_;
  std::vector<double> area_;  // per slot
  Merges& merges_;
  std::vector<int32_t> node_;  // per slot
  std::vector<float> pushed_;  // per edge: the score of its one valid entry
  std::vector<Entry> heap_;
};

}  // namespace

PartTree build_nbm_tree(const Surface& surface, const NbmOptions& options, const Context& context,
                        std::span<const double> face_areas) {
  const std::vector<double> area = area_shares(surface, face_areas);
  Merges merges(surface.face_count());
  BoundaryMerger(crease_edges(surface, options), area, merges).run(context);
  join_components(surface, area, merges, context);
  return context.cancelled() ? pair_off(surface.face_count()) : std::move(merges).finish();
}

}  // namespace partuv
