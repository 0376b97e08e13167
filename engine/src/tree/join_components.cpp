#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "partuv/surface.hpp"
#include "tree/merges.hpp"
#include "tree/region_tree.hpp"

namespace partuv {

namespace {

struct Root {
  int32_t node = -1;
  Region region;
};

std::vector<Root> component_roots(const Surface& surface, const std::vector<double>& area,
                                  const Merges& merges) {
  std::vector<int32_t> component;
  std::vector<Root> roots(label_components(surface, component));
  for (int f = 0; f < surface.face_count(); ++f) {
    Root& root = roots[component[f]];
    const Triangle& t = surface.faces[f];
    const Vec3 centroid =
        (surface.positions[t[0]] + surface.positions[t[1]] + surface.positions[t[2]]) / 3.0;
    root.region.area += area[f];
    root.region.mean += area[f] * centroid;
    root.node = f;
  }
  for (Root& root : roots) root.region.mean /= root.region.area;
  // The last merge of a component is its root.
  component.reserve(surface.face_count() + merges.count());
  for (int m = 0; m < merges.count(); ++m) {
    component.push_back(component[merges.left(m)]);
    roots[component.back()].node = surface.face_count() + m;
  }
  return roots;
}

struct Join {
  double cost;
  int32_t a, b;  ///< clusters: roots, then earlier joins
};

/// Nearest-neighbour chain (Murtagh 1983): follow nearest neighbours until two are each other's.
/// Ward's criterion is reducible, so joining them at once gives the tree of the greedy order.
/// Returns fewer joins than it takes to one cluster if the context is stopping.
std::vector<Join> chain_joins(const std::vector<Root>& roots, const Context& context) {
  const int count = static_cast<int>(roots.size());
  std::vector<Region> regions(count);
  for (int i = 0; i < count; ++i) regions[i] = roots[i].region;
  RegionTree tree(std::move(regions));
  std::vector<int32_t> cluster(count);  // the cluster that each slot of the tree holds
  std::iota(cluster.begin(), cluster.end(), 0);
  std::vector<Join> joins;
  joins.reserve(count - 1);
  std::vector<int32_t> chain;
  int start = -1;
  for (int step = 0; static_cast<int>(joins.size()) + 1 < count; ++step) {
    if (step % 256 == 0 && context.stopping()) break;
    if (chain.empty()) {
      // Going round coarsens all places alike, which keeps the boxes of the tree tight.
      do {
        start = (start + 1) % count;
      } while (!tree.alive(start));
      chain.push_back(start);
    }
    const int tip = chain.back();
    const int previous = chain.size() > 1 ? chain[chain.size() - 2] : -1;
    const int nearest = tree.nearest(tip, previous);
    if (nearest != previous) {
      chain.push_back(nearest);
      continue;
    }
    chain.resize(chain.size() - 2);
    joins.push_back({tree.cost(tip, previous), cluster[tip], cluster[previous]});
    cluster[tree.merge(previous, tip)] = count + static_cast<int>(joins.size()) - 1;
  }
  return joins;
}

/// The joins in the greedy order: by cost, a join never before those it builds on.
std::vector<int32_t> greedy_order(std::vector<Join>& joins, int roots) {
  for (Join& join : joins) {
    for (const int child : {join.a, join.b}) {
      if (child >= roots) join.cost = std::max(join.cost, joins[child - roots].cost);
    }
  }
  std::vector<int32_t> order(joins.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return joins[a].cost < joins[b].cost; });
  return order;
}

/// Join the nodes two by two, round by round.
void pair_off(std::vector<int32_t> nodes, Merges& merges) {
  for (size_t i = 0; i + 1 < nodes.size(); i += 2) {
    nodes.push_back(merges.join(nodes[i], nodes[i + 1]));
  }
}

}  // namespace

void join_components(const Surface& surface, const std::vector<double>& area, Merges& merges,
                     const Context& context) {
  if (context.cancelled()) return;
  const std::vector<Root> roots = component_roots(surface, area, merges);
  const int count = static_cast<int>(roots.size());
  if (count <= 1) return;
  std::vector<Join> joins = chain_joins(roots, context);
  std::vector<int32_t> node(count + joins.size());
  std::vector<char> open(node.size(), 1);
  for (int i = 0; i < count; ++i) node[i] = roots[i].node;
  for (const int j : greedy_order(joins, count)) {
    node[count + j] = merges.join(node[joins[j].a], node[joins[j].b]);
    open[joins[j].a] = open[joins[j].b] = 0;
  }
  // What is left if the time ran out.
  std::vector<int32_t> rest;
  for (size_t i = 0; i < node.size(); ++i) {
    if (open[i]) rest.push_back(node[i]);
  }
  pair_off(std::move(rest), merges);
}

PartTree pair_off(int face_count) {
  std::vector<int32_t> faces(face_count);
  std::iota(faces.begin(), faces.end(), 0);
  Merges merges(face_count);
  pair_off(std::move(faces), merges);
  return std::move(merges).finish();
}

}  // namespace partuv
