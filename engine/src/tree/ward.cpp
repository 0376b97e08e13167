#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "partuv/tree_ward.hpp"
#include "rounded.hpp"
#include "tree/contraction.hpp"
#include "tree/merges.hpp"

namespace partuv {

namespace {

// A region with more neighbours than this is compared anew with all of them only when it has grown
// by this share; in between with those it has just met. Without it, one region that absorbs noise
// face by face would cost the square of the number of faces.
constexpr int hub_degree = 256;
constexpr double hub_growth = 1.0 / 16.0;

// Squared distance of features, over their mean squared length, that counts as none: normals of a
// plane differ by so much through the rounding of single precision.
constexpr double least_distance = 1e-9;

struct Entry {
  float cost;
  int32_t high, low;  ///< nodes
  int32_t edge;
  int32_t version;  ///< of the edge: earlier ones no longer count
};

/// The order of a heap with the least cost, then the oldest nodes, on top: newer regions wait, so
/// that equal features give a balanced tree.
struct Later {
  bool operator()(const Entry& a, const Entry& b) const {
    if (a.cost != b.cost) return a.cost > b.cost;
    if (a.high != b.high) return a.high > b.high;
    return a.low > b.low;
  }
};

class WardMerger {
 public:
  WardMerger(const std::vector<DualEdge>& edges, std::vector<double> area, std::vector<double> mean,
             Merges& merges)
      : graph_(static_cast<int>(area.size()), edges),
        dimensions_(mean.size() / std::max<size_t>(area.size(), 1)),
        area_(area),
        compared_area_(std::move(area)),
        mean_(std::move(mean)),
        merges_(merges),
        node_(area_.size()),
        version_(graph_.edge_count(), 0) {
    std::iota(node_.begin(), node_.end(), 0);
    double squares = 0.0;
    for (const double x : mean_) squares += x * x;
    negligible_ = least_distance * squares / std::max<double>(1.0, double(area_.size()));
    heap_.reserve(most_entries());
    for (int e = 0; e < graph_.edge_count(); ++e) heap_.push_back(entry(e));
    std::make_heap(heap_.begin(), heap_.end(), Later());
  }

  void run(const Context& context) {
    constexpr uint32_t steps_between_checks = 256;
    for (uint32_t step = 1; !heap_.empty(); ++step) {
      if (step % steps_between_checks == 0 && context.stopping()) {
        return contract_in_rounds(graph_, context, [&](int e) { join_nodes(e); });
      }
      std::pop_heap(heap_.begin(), heap_.end(), Later());
      const Entry top = heap_.back();
      heap_.pop_back();
      if (valid(top)) merge(top.edge);
    }
  }

 private:
  bool valid(const Entry& entry) const {
    return graph_.alive(entry.edge) && version_[entry.edge] == entry.version;
  }

  Entry entry(int e) const {
    const auto [a, b] = graph_.edge(e).slot;
    const double *p = &mean_[a * dimensions_], *q = &mean_[b * dimensions_];
    double squared = 0.0;
    for (size_t k = 0; k < dimensions_; ++k) squared += (p[k] - q[k]) * (p[k] - q[k]);
    const auto [low, high] = std::minmax(node_[a], node_[b]);
    if (squared <= negligible_) squared = 0.0;
    const double cost = area_[a] * area_[b] / (area_[a] + area_[b]) * squared;
    return {rounded(cost), high, low, e, version_[e]};
  }

  void push(int e) {
    ++version_[e];
    if (heap_.size() >= most_entries()) drop_invalid_entries();
    heap_.push_back(entry(e));
    std::push_heap(heap_.begin(), heap_.end(), Later());
  }

  size_t most_entries() const {
    constexpr size_t entries_per_edge = 4, least = 1024;
    return entries_per_edge * graph_.living_edge_count() + least;
  }

  void drop_invalid_entries() {
    std::erase_if(heap_, [&](const Entry& entry) { return !valid(entry); });
    std::make_heap(heap_.begin(), heap_.end(), Later());
  }

  void merge(int e) {
    join_nodes(e);
    join_means(e);
    changed_.clear();
    const int kept = graph_.contract(e, [&](int edge, bool) { changed_.push_back(edge); });
    if (graph_.degree(kept) > hub_degree &&
        area_[kept] < (1.0 + hub_growth) * compared_area_[kept]) {
      for (const int edge : changed_) push(edge);
      return;
    }
    compared_area_[kept] = area_[kept];
    graph_.for_each_edge(kept, [&](int edge, int) { push(edge); });
  }

  // Both slots become the new region: which one survives the contraction is the graph's business.
  void join_nodes(int e) {
    const auto [a, b] = graph_.edge(e).slot;
    node_[a] = node_[b] = merges_.join(node_[a], node_[b]);
  }

  void join_means(int e) {
    const auto [a, b] = graph_.edge(e).slot;
    const double area = area_[a] + area_[b], share = area_[b] / area;
    double *p = &mean_[a * dimensions_], *q = &mean_[b * dimensions_];
    for (size_t k = 0; k < dimensions_; ++k) p[k] = q[k] = p[k] + share * (q[k] - p[k]);
    area_[a] = area_[b] = area;
  }

  ContractionGraph graph_;
  size_t dimensions_;
  double negligible_ = 0.0;                          ///< squared distance
  std::vector<double> area_, compared_area_, mean_;  // per slot
  Merges& merges_;
  std::vector<int32_t> node_;     // per slot
  std::vector<int32_t> version_;  // per edge
  std::vector<int32_t> changed_;  // by the last contraction
  std::vector<Entry> heap_;
};

template <typename T>
Result<PartTree> build(const Surface& surface, std::span<const T> features, int dimensions,
                       const Context& context, std::span<const double> face_areas) {
  const size_t faces = surface.faces.size();
  if (dimensions < 1 || features.size() != faces * static_cast<size_t>(dimensions)) {
    return Failure{Error::invalid_tree, "features: expected " + std::to_string(faces) +
                                            " rows of " + std::to_string(dimensions)};
  }
  for (size_t i = 0; i < features.size(); ++i) {
    if (!std::isfinite(features[i])) {
      return Failure{Error::invalid_tree,
                     "features of face " + std::to_string(i / dimensions) + ": not finite"};
    }
  }
  std::vector<double> area = area_shares(surface, face_areas);
  Merges merges(surface.face_count());
  WardMerger(dual_edges(surface), area, {features.begin(), features.end()}, merges).run(context);
  join_components(surface, area, merges, context);
  if (context.cancelled()) return Failure{Error::cancelled, "part tree"};
  return std::move(merges).finish();
}

}  // namespace

Result<PartTree> build_ward_tree(const Surface& surface, std::span<const float> features,
                                 int dimensions, const Context& context,
                                 std::span<const double> face_areas) {
  return build(surface, features, dimensions, context, face_areas);
}

Result<PartTree> build_ward_tree(const Surface& surface, std::span<const double> features,
                                 int dimensions, const Context& context,
                                 std::span<const double> face_areas) {
  return build(surface, features, dimensions, context, face_areas);
}

}  // namespace partuv
