#include "segment/runs.hpp"

#include <algorithm>
#include <numeric>

#include "disjoint_sets.hpp"
#include "rounded.hpp"

namespace partuv {

std::vector<std::vector<int32_t>> connected_runs(const Surface& surface,
                                                 const std::vector<int32_t>& sides) {
  std::vector<std::pair<int32_t, int32_t>> ends;  // (vertex, index in `sides`)
  for (size_t i = 0; i < sides.size(); ++i) {
    const Triangle& t = surface.faces[sides[i] / 3];
    ends.emplace_back(t[sides[i] % 3], static_cast<int32_t>(i));
    ends.emplace_back(t[(sides[i] % 3 + 1) % 3], static_cast<int32_t>(i));
  }
  std::sort(ends.begin(), ends.end());
  DisjointSets joined(static_cast<int>(sides.size()));
  for (size_t i = 1; i < ends.size(); ++i) {
    if (ends[i].first == ends[i - 1].first) joined.join(ends[i].second, ends[i - 1].second);
  }
  std::vector<int32_t> run_of_root(sides.size(), -1);
  std::vector<std::vector<int32_t>> runs;
  std::vector<double> length;
  for (size_t i = 0; i < sides.size(); ++i) {
    int32_t& run = run_of_root[joined.find(static_cast<int>(i))];
    if (run < 0) {
      run = static_cast<int32_t>(runs.size());
      runs.emplace_back();
      length.push_back(0.0);
    }
    runs[run].push_back(sides[i]);
    length[run] += side_length(surface, sides[i]);
  }
  std::vector<int32_t> order(runs.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return rounded(length[a]) > rounded(length[b]); });
  std::vector<std::vector<int32_t>> sorted;
  for (const int run : order) sorted.push_back(std::move(runs[run]));
  return sorted;
}

}  // namespace partuv
