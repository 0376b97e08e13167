// The search over the part tree against every combination that the tree allows.
#include <algorithm>
#include <numeric>
#include <random>
#include <thread>

#include "check.hpp"
#include "partuv/search.hpp"
#include "segment/evaluator.hpp"
#include "segment/look_ahead.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

/// A tree of random merges of adjacent clusters; with `anywhere`, of any two.
PartTree random_tree(const Surface& s, bool anywhere, std::mt19937& random) {
  const int n = s.face_count();
  std::vector<int32_t> node_of(n), left, right;
  std::iota(node_of.begin(), node_of.end(), 0);
  for (int merge = 0; merge < n - 1; ++merge) {
    std::vector<std::pair<int32_t, int32_t>> pairs;
    for (int f = 0; f < n; ++f) {
      for (int g = 0; g < n; ++g) {
        const bool adjacent = std::any_of(s.opposite[f].begin(), s.opposite[f].end(),
                                          [&](int h) { return h >= 0 && h / 3 == g; });
        if (node_of[f] < node_of[g] && (anywhere || adjacent)) {
          pairs.emplace_back(node_of[f], node_of[g]);
        }
      }
    }
    const auto [a, b] = pairs[std::uniform_int_distribution<size_t>(0, pairs.size() - 1)(random)];
    left.push_back(a);
    right.push_back(b);
    for (int& node : node_of) {
      if (node == a || node == b) node = n + merge;
    }
  }
  return make_tree(n, std::move(left), std::move(right));
}

/// The numbers of charts of all combinations below a node: its own heuristics, or one combination
/// of either child.
std::vector<int> combinations(Evaluator& evaluator, const PartTree& tree, int node) {
  if (tree.is_leaf(node)) return {1};
  std::vector<int> counts;
  std::vector<int32_t> faces(tree.order.begin() + tree.begin[node],
                             tree.order.begin() + tree.end[node]);
  std::sort(faces.begin(), faces.end());
  if (connected_parts(evaluator.surface(), faces).size() == 1) {
    const int most = evaluator.options().most_normal_charts;
    if (const auto normal = normal_heuristic(evaluator, faces, most)) {
      counts.push_back(static_cast<int>(normal->size()));
      if (const auto merged = merge_heuristic(evaluator, faces, counts[0] - 1)) {
        counts.push_back(static_cast<int>(merged->size()));
      }
    }
  }
  const int merge = node - tree.face_count;
  const std::vector<int> l = combinations(evaluator, tree, tree.left[merge]);
  const std::vector<int> r = combinations(evaluator, tree, tree.right[merge]);
  for (const int a : l) {
    for (const int b : r) counts.push_back(a + b);
  }
  return counts;
}

void check_charts(const Surface& s, const ChartSet& charts, Evaluator& evaluator) {
  std::vector<int> times(s.faces.size(), 0);
  for (const Chart& chart : charts) {
    for (const int f : chart.faces) ++times[f];
    CHECK(std::is_sorted(chart.faces.begin(), chart.faces.end()));
    CHECK(evaluator.chart(chart.faces).has_value());
  }
  CHECK(std::all_of(times.begin(), times.end(), [](int t) { return t == 1; }));
}

void test_fewest_charts() {
  std::mt19937 random(1);
  int several = 0;
  for (const Mesh& shape : {sphere(0), pierced_plate(0), tube(5, 1), sheet(2, 3), sphere(1)}) {
    for (int round = 0; round < 6; ++round) {
      Mesh mesh = shape;
      shake(mesh, 0.6, random);
      const Surface s = surface_of(mesh);
      const std::vector<double> weight(s.faces.size(), 1.0);
      // Trees over faces that are not adjacent have more combinations, of unconnected nodes.
      const PartTree tree = random_tree(s, round % 3 == 2, random);
      SearchOptions options;
      options.flatten.max_area_distortion = round % 2 == 0 ? 1.1 : 1.01;
      options.final_merge = false;
      Context context;
      Evaluator evaluator(s, weight, options, context);
      const std::vector<int> all = combinations(evaluator, tree, tree.root());
      const int fewest = *std::min_element(all.begin(), all.end());
      const ChartSet found = search_charts(s, tree, weight, options, context);
      check_charts(s, found, evaluator);
      CHECK(static_cast<int>(found.size()) <= fewest);
      several += fewest > 2;

      Context two(2);
      const ChartSet again = search_charts(s, tree, weight, options, two);
      CHECK(std::equal(found.begin(), found.end(), again.begin(), again.end(),
                       [](const Chart& a, const Chart& b) { return a.faces == b.faces; }));
      options.recursion = false;
      CHECK(search_charts(s, tree, weight, options, context).size() >= found.size());
      options.recursion = true;
      options.final_merge = true;
      CHECK(search_charts(s, tree, weight, options, context).size() <= found.size());
    }
  }
  CHECK(several >= 5);  // most cases must be worth a search
}

/// What Merge finds counts if it saves as many charts as asked for.
void test_least_gain_of_merge() {
  std::mt19937 random(5);
  int too_few = 0, enough = 0;
  for (int round = 0; round < 120; ++round) {
    Mesh mesh = tube(8, 3);
    shake(mesh, 0.2, random);
    const Surface s = surface_of(mesh);
    const std::vector<double> weight(s.faces.size(), 1.0);
    SearchOptions options;
    options.flatten.max_area_distortion = 1.1;
    options.recursion = options.final_merge = false;
    options.least_merge_gain = 2;
    Context context;
    Evaluator evaluator(s, weight, options, context);
    std::vector<int32_t> faces(s.faces.size());
    std::iota(faces.begin(), faces.end(), 0);
    const auto normal = normal_heuristic(evaluator, faces, options.most_normal_charts);
    if (!normal || normal->size() < 3) continue;
    const auto merged = merge_heuristic(evaluator, faces, static_cast<int>(normal->size()) - 1);
    if (!merged) continue;
    const bool counts = merged->size() + 2 <= normal->size();
    ++(counts ? enough : too_few);
    const PartTree tree = random_tree(s, false, random);
    CHECK(search_charts(s, tree, weight, options, context).size() ==
          (counts ? merged : normal)->size());
    options.least_merge_gain = 1;
    CHECK(search_charts(s, tree, weight, options, context).size() == merged->size());
  }
  CHECK(too_few >= 3);
  CHECK(enough >= 3);
}

/// A tree that parts the middle columns of a strip from its two ends, then takes one face after the
/// other off one end: each level splits a component of an unconnected node.
PartTree peeling_tree(int rows, int columns, int middle, int peeled) {
  const int n = 2 * rows * columns;
  std::vector<int32_t> left, right;
  const auto merge = [&](int a, int b) {
    left.push_back(a);
    right.push_back(b);
    return n + static_cast<int>(left.size()) - 1;
  };
  std::vector<int> first_end, band, other_end;
  for (int f = 0; f < n; ++f) {
    const int column = f / 2 % columns;
    (column < middle ? first_end : column == middle ? band : other_end).push_back(f);
  }
  const auto gathered = [&](const std::vector<int>& faces, size_t from) {
    int node = faces[from];
    for (size_t i = from + 1; i < faces.size(); ++i) node = merge(node, faces[i]);
    return node;
  };
  int rest = merge(gathered(first_end, peeled), gathered(other_end, 0));
  for (int i = peeled - 1; i >= 0; --i) rest = merge(first_end[i], rest);
  merge(gathered(band, 0), rest);
  return make_tree(n, std::move(left), std::move(right));
}

/// The components of a node may use up what a better combination could have: it is none then.
void test_exhausted_budget() {
  constexpr int rows = 2, columns = 24;
  std::mt19937 random(3);
  for (int round = 0; round < 60; ++round) {
    Mesh mesh = sheet(rows, columns);
    shake(mesh, 0.05, random);
    const Surface s = surface_of(mesh);
    const std::vector<double> weight(s.faces.size(), 1.0);
    const PartTree tree = peeling_tree(rows, columns, 10 + round % 4, 14);
    SearchOptions options;
    options.most_normal_charts = 60;
    options.flatten.max_area_distortion = 1.01;
    options.final_merge = false;
    Context context;
    Evaluator evaluator(s, weight, options, context);
    const ChartSet found = search_charts(s, tree, weight, options, context);
    check_charts(s, found, evaluator);
  }
}

/// What is expected is answered on other threads, without being asked.
void test_looking_ahead() {
  const Surface s = surface_of(sheet(6, 40));
  const std::vector<double> weight(s.faces.size(), 1.0);
  const SearchOptions options;
  const Context context(3);
  Evaluator evaluator(s, weight, options, context);
  std::vector<LookAhead::Question> questions;
  for (int32_t i = 0; i < 8; ++i) {
    LookAhead::Question question{{i, 0, 0, 0, 0}, i % 2 == 0, {}};
    for (int32_t f = 0; f < 60 * (i + 1); ++f) question.faces.push_back(f);
    questions.push_back(question);
  }
  {
    LookAhead ahead(evaluator);
    CHECK(ahead.possible());
    ahead.expect(questions);
    const auto limit = Context::Clock::now() + std::chrono::seconds(60);
    const auto all_begun = [&] {
      return std::all_of(questions.begin(), questions.end(),
                         [&](const auto& question) { return ahead.begun(question.key); });
    };
    while (!all_begun() && Context::Clock::now() < limit) std::this_thread::yield();
    CHECK(all_begun());
  }
  CHECK(context.free_threads() == 3);
  for (const auto& question : questions) {
    CHECK(evaluator.known_prediction(question.faces).has_value());
    CHECK(evaluator.chart(question.faces).has_value());
  }
}

/// Merging finds the same charts however many threads look ahead.
void test_merging_with_threads() {
  std::mt19937 random(7);
  Mesh mesh = sphere(3);
  shake(mesh, 0.02, random);
  const Surface s = surface_of(mesh);
  const std::vector<double> weight(s.faces.size(), 1.0);
  const SearchOptions options;
  std::vector<std::vector<std::vector<int32_t>>> found;
  for (const int threads : {1, 2, 4}) {
    const Context context(threads);
    Evaluator evaluator(s, weight, options, context);
    ChartSet charts(s.faces.size());
    for (int32_t f = 0; f < s.face_count(); ++f) charts[f].faces.push_back(f);
    merge_charts(evaluator, charts);
    CHECK(charts.size() < s.faces.size() / 8);
    CHECK(context.free_threads() == threads);
    std::vector<std::vector<int32_t>>& faces = found.emplace_back();
    for (const Chart& chart : charts) faces.push_back(chart.faces);
  }
  CHECK(found[0] == found[1] && found[0] == found[2]);
}

}  // namespace
}  // namespace partuv::test

int main() {
  partuv::test::test_fewest_charts();
  partuv::test::test_least_gain_of_merge();
  partuv::test::test_exhausted_budget();
  partuv::test::test_looking_ahead();
  partuv::test::test_merging_with_threads();
  return partuv::test::failures;
}
