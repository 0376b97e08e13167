#include "tree/region_tree.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "rounded.hpp"

namespace partuv {

namespace {

constexpr int leaf_size = 8;
constexpr double area_spread = 4.0;
constexpr double rebuild_share = 0.7;
constexpr double infinity = std::numeric_limits<double>::infinity();
// Squared share of the extent that rounding alone may put between two means.
constexpr double least_distance = 1e-12;

}  // namespace

RegionTree::RegionTree(std::vector<Region> regions)
    : regions_(std::move(regions)), leaf_(regions_.size(), 0) {
  living_ = static_cast<int>(regions_.size());
  build();
  negligible_ = least_distance * (nodes_.front().high - nodes_.front().low).squaredNorm();
}

float RegionTree::ward_cost(double area_a, double area_b, double squared_distance) const {
  if (squared_distance <= negligible_) return 0.0f;
  return rounded(area_a * area_b / (area_a + area_b) * squared_distance);
}

float RegionTree::cost(int a, int b) const {
  return ward_cost(regions_[a].area, regions_[b].area,
                   (regions_[a].mean - regions_[b].mean).squaredNorm());
}

void RegionTree::build() {
  items_.clear();
  for (size_t i = 0; i < regions_.size(); ++i) {
    if (alive(static_cast<int>(i))) items_.push_back(static_cast<int32_t>(i));
  }
  nodes_.clear();
  build_node(0, static_cast<int>(items_.size()), -1);
  living_at_build_ = living_;
}

int RegionTree::build_node(int begin, int end, int parent) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  nodes_[index].parent = parent;
  nodes_[index].begin = begin;
  nodes_[index].end = end;
  if (end - begin <= leaf_size) {
    for (int i = begin; i < end; ++i) leaf_[items_[i]] = index;
    fit(nodes_[index]);
    return index;
  }
  // Areas apart come first: where they differ little, the cheapest partner is a near one.
  const int axis = split_axis(begin, end);
  auto key = [&](int i) { return axis < 0 ? regions_[i].area : regions_[i].mean[axis]; };
  const int middle = (begin + end) / 2;
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                   [&](int a, int b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  const int first = build_node(begin, middle, index);
  const int second = build_node(middle, end, index);
  nodes_[index].child[0] = first;
  nodes_[index].child[1] = second;
  fit(nodes_[index]);
  return index;
}

/// The axis of the largest extent, or -1 for the area.
int RegionTree::split_axis(int begin, int end) const {
  Vec3 low = Vec3::Constant(infinity), high = -low;
  double least_area = infinity, largest_area = 0.0;
  for (int i = begin; i < end; ++i) {
    const Region& region = regions_[items_[i]];
    low = low.cwiseMin(region.mean);
    high = high.cwiseMax(region.mean);
    least_area = std::min(least_area, region.area);
    largest_area = std::max(largest_area, region.area);
  }
  if (largest_area > area_spread * least_area) return -1;
  int axis = 0;
  (high - low).maxCoeff(&axis);
  return axis;
}

void RegionTree::fit(Node& node) const {
  node.low.setConstant(infinity);
  node.high.setConstant(-infinity);
  node.least_area = infinity;
  if (node.child[0] < 0) {
    for (int i = node.begin; i < node.end; ++i) {
      if (!alive(items_[i])) continue;
      const Region& region = regions_[items_[i]];
      node.low = node.low.cwiseMin(region.mean);
      node.high = node.high.cwiseMax(region.mean);
      node.least_area = std::min(node.least_area, region.area);
    }
    return;
  }
  for (const int c : node.child) {
    node.low = node.low.cwiseMin(nodes_[c].low);
    node.high = node.high.cwiseMax(nodes_[c].high);
    node.least_area = std::min(node.least_area, nodes_[c].least_area);
  }
}

void RegionTree::refit_from(int leaf) {
  for (int n = leaf; n >= 0; n = nodes_[n].parent) fit(nodes_[n]);
}

int RegionTree::merge(int a, int b) {
  const float area_a = rounded(regions_[a].area), area_b = rounded(regions_[b].area);
  const int kept = area_a != area_b ? (area_a < area_b ? b : a) : std::min(a, b);
  const int gone = a + b - kept;
  Region& region = regions_[kept];
  const double area = region.area + regions_[gone].area;
  region.mean += (regions_[gone].mean - region.mean) * (regions_[gone].area / area);
  region.area = area;
  const int emptied = std::exchange(leaf_[gone], -1);
  --living_;
  if (rebuild_share * living_at_build_ > living_) {
    build();
  } else {
    refit_from(leaf_[kept]);
    refit_from(emptied);
  }
  return kept;
}

float RegionTree::least_cost(const Node& node, const Region& region) const {
  if (node.least_area == infinity) return std::numeric_limits<float>::infinity();
  const Vec3 outside =
      (node.low - region.mean).cwiseMax(region.mean - node.high).cwiseMax(Vec3::Zero());
  return ward_cost(region.area, node.least_area, outside.squaredNorm());
}

int RegionTree::nearest(int region, int previous) const {
  Candidate best{previous,
                 previous >= 0 ? cost(region, previous) : std::numeric_limits<float>::infinity()};
  // The own leaf gives a bound to start with; then depth first, the cheaper child first. The height
  // is at most log2 of the number of regions.
  look_in_leaf(nodes_[leaf_[region]], region, previous, best);
  std::array<std::pair<float, int32_t>, 64> stack;
  int depth = 0;
  stack[depth++] = {0.0f, 0};
  while (depth > 0) {
    const auto [bound, index] = stack[--depth];
    if (bound > best.cost && best.region >= 0) continue;
    const Node& node = nodes_[index];
    if (node.child[0] < 0) {
      if (index != leaf_[region]) look_in_leaf(node, region, previous, best);
      continue;
    }
    float near = least_cost(nodes_[node.child[0]], regions_[region]);
    float far = least_cost(nodes_[node.child[1]], regions_[region]);
    int first = node.child[0], second = node.child[1];
    if (far < near) {
      std::swap(near, far);
      std::swap(first, second);
    }
    if (far <= best.cost || best.region < 0) stack[depth++] = {far, second};
    stack[depth++] = {near, first};
  }
  return best.region;
}

void RegionTree::look_in_leaf(const Node& leaf, int region, int previous, Candidate& best) const {
  for (int i = leaf.begin; i < leaf.end; ++i) {
    const int other = items_[i];
    if (other == region || !alive(other)) continue;
    const float c = cost(region, other);
    const bool earlier = c == best.cost && best.region != previous && other < best.region;
    if (best.region < 0 || c < best.cost || earlier) best = {other, c};
  }
}

}  // namespace partuv
