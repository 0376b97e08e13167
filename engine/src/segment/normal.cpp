#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>

#include "partuv/tree_ward.hpp"
#include "segment/evaluator.hpp"
#include "tree/steady_normals.hpp"

namespace partuv {
namespace {

/// Clusters of a tree when it is cut into `count`, largest first.
std::vector<int32_t> cut_nodes(const PartTree& tree, int count) {
  std::vector<int32_t> nodes{tree.root()};
  while (static_cast<int>(nodes.size()) < count) {
    // The last merge is undone first.
    const auto last = std::max_element(nodes.begin(), nodes.end());
    if (tree.is_leaf(*last)) break;
    const int merge = *last - tree.face_count;
    *last = tree.left[merge];
    nodes.push_back(tree.right[merge]);
  }
  std::sort(nodes.begin(), nodes.end(), [&](int a, int b) {
    return tree.size(a) != tree.size(b) ? tree.size(a) > tree.size(b) : a < b;
  });
  return nodes;
}

/// The clustering into `count` clusters as charts, if all of them flatten within the bounds. Gives
/// up once `fewest`, which another thread may lower, is below.
std::optional<ChartSet> chart_clusters(Evaluator& evaluator, const std::vector<int32_t>& faces,
                                       const PartTree& tree, int count,
                                       const std::atomic<int>& fewest) {
  std::vector<std::vector<int32_t>> clusters;
  for (int node : cut_nodes(tree, count)) {
    std::vector<int32_t> cluster;
    for (int i = tree.begin[node]; i < tree.end[node]; ++i) cluster.push_back(faces[tree.order[i]]);
    std::sort(cluster.begin(), cluster.end());
    clusters.push_back(std::move(cluster));
  }
  const Context& context = evaluator.context();
  const int number = static_cast<int>(clusters.size());
  const auto worth_it = [&] { return !context.stopping() && fewest >= count; };
  const bool promising = parallel_all(context, number, [&](int i) {
    return worth_it() && evaluator.predicted(clusters[i]) <= evaluator.limit();
  });
  if (!promising) return std::nullopt;
  ChartSet charts(number);
  const bool flat = parallel_all(context, number, [&](int i) {
    std::optional<Chart> chart = worth_it() ? evaluator.chart(clusters[i]) : std::nullopt;
    if (chart) charts[i] = std::move(*chart);
    return chart.has_value();
  });
  if (!flat) return std::nullopt;
  return charts;
}

}  // namespace

std::optional<PartTree> normals_tree(const Surface& surface, const Context& context) {
  const int n = surface.face_count();
  std::vector<double> normals(3 * n);
  const std::vector<Vec3> steady = steady_normals(surface);
  for (int f = 0; f < n; ++f) {
    for (int k = 0; k < 3; ++k) normals[3 * f + k] = steady[f][k];
  }
  Result<PartTree> tree = build_ward_tree(surface, std::span<const double>(normals), 3, context);
  if (!tree) return std::nullopt;
  return std::move(tree.value());
}

std::vector<std::vector<int32_t>> normal_halves(const Surface& surface,
                                                const std::vector<int32_t>& faces,
                                                const Context& context) {
  const std::optional<PartTree> found =
      normals_tree(extract_piece(surface, faces, {}).surface, context);
  if (!found) return {faces};
  const PartTree& tree = *found;
  const int merge = tree.root() - tree.face_count;
  std::vector<std::vector<int32_t>> halves;
  for (const int node : {tree.left[merge], tree.right[merge]}) {
    std::vector<int32_t> half;
    for (int i = tree.begin[node]; i < tree.end[node]; ++i) half.push_back(faces[tree.order[i]]);
    std::sort(half.begin(), half.end());
    halves.push_back(std::move(half));
  }
  return halves;
}

std::optional<ChartSet> normal_heuristic(Evaluator& evaluator, const std::vector<int32_t>& faces,
                                         int most_charts) {
  const int most = std::min(most_charts, static_cast<int>(faces.size()));
  std::once_flag once;
  std::optional<PartTree> tree;
  const auto grow_tree = [&] {
    const Piece piece = extract_piece(evaluator.surface(), faces, evaluator.weight());
    tree = normals_tree(piece.surface, evaluator.context());
  };
  // The clusterings do not depend on each other: where threads are free, twice as many at a time,
  // so that none waits long for the others. The one with the fewest charts counts.
  for (int first = 1, tried = 0; first <= most; first += tried) {
    const int free = evaluator.context().free_threads();
    tried = std::min(free > 1 ? 2 * free : 1, most - first + 1);
    std::vector<std::optional<ChartSet>> found(tried);
    std::atomic<int> fewest = std::numeric_limits<int>::max();
    parallel_for(evaluator.context(), tried, [&](int i) {
      const int count = first + i;
      if (count == 1) {
        if (auto whole = evaluator.chart(faces)) found[i] = ChartSet{std::move(*whole)};
      } else {
        std::call_once(once, grow_tree);
        if (tree) found[i] = chart_clusters(evaluator, faces, *tree, count, fewest);
      }
      for (int known = fewest; found[i] && count < known;) {
        fewest.compare_exchange_weak(known, count);
      }
    });
    if (evaluator.context().stopping()) return std::nullopt;
    for (auto& charts : found) {
      if (charts) return std::move(charts);
    }
  }
  return std::nullopt;
}

}  // namespace partuv
