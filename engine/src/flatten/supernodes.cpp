#include "flatten/supernodes.hpp"

#include <algorithm>

namespace partuv {
namespace {

/// Entries below the diagonal in each column of the factor.
std::vector<int32_t> column_counts(const LowerPattern& lower) {
  const int rows = lower.rows();
  std::vector<int32_t> count(rows, 0), mark(rows, -1);
  for (int k = 0; k < rows; ++k) {
    mark[k] = k;
    for (int p = lower.start[k]; p < lower.start[k + 1]; ++p) {
      for (int i = lower.before[p]; mark[i] != k; i = lower.parent[i]) {
        ++count[i];
        mark[i] = k;
      }
    }
  }
  return count;
}

/// A run of columns on its way to become a supernode.
struct Run {
  int32_t first, end;
  int64_t height;   ///< own columns and rows below
  int64_t entries;  ///< of the factor, without the zeros that joining brings in

  int64_t size() const {
    const int64_t columns = end - first;
    return columns * height - columns * (columns - 1) / 2;
  }
};

/// True if a front for both is worth the zeros in it.
bool worth_joining(const Run& both) {
  const int64_t columns = both.end - both.first;
  const double zeros = 1.0 - static_cast<double>(both.entries) / static_cast<double>(both.size());
  return columns <= 4 || (columns <= 16 && zeros < 0.4) || (columns <= 48 && zeros < 0.1) ||
         zeros < 0.05;
}

std::vector<int32_t> joined_runs(const std::vector<int32_t>& parent,
                                 const std::vector<int32_t>& count) {
  const int rows = static_cast<int>(parent.size());
  std::vector<Run> runs;
  for (int j = 0; j < rows; ++j) {
    if (j > 0 && parent[j - 1] == j && count[j - 1] == count[j] + 1) {
      runs.back().end = j + 1;
      runs.back().entries += count[j] + 1;
    } else {
      // Fundamental runs end before a column with another structure.
      runs.push_back({j, j + 1, count[j] + 1, count[j] + 1});
    }
  }
  std::vector<Run> kept;
  for (const Run& run : runs) {
    kept.push_back(run);
    while (kept.size() > 1) {
      const Run &child = kept[kept.size() - 2], &top = kept.back();
      const int32_t above = parent[child.end - 1];
      if (above < top.first || above >= top.end) break;
      const Run both{child.first, top.end, child.end - child.first + top.height,
                     child.entries + top.entries};
      if (!worth_joining(both)) break;
      kept.pop_back();
      kept.back() = both;
    }
  }
  std::vector<int32_t> first;
  for (const Run& run : kept) first.push_back(run.first);
  first.push_back(rows);
  return first;
}

}  // namespace

Supernodes find_supernodes(const LowerPattern& lower) {
  const int rows = lower.rows();
  const std::vector<int32_t>& before = lower.before;
  Supernodes s;
  s.first = joined_runs(lower.parent, column_counts(lower));
  const int count = static_cast<int>(s.first.size()) - 1;

  s.column_start.assign(rows + 1, 0);
  for (const int j : before) ++s.column_start[j + 1];
  for (int j = 0; j < rows; ++j) s.column_start[j + 1] += s.column_start[j];
  s.entry.resize(before.size());
  s.entry_place.resize(before.size());
  std::vector<int32_t> row_of_entry(before.size());
  std::vector<int32_t> fill(s.column_start.begin(), s.column_start.end() - 1);
  for (int k = 0; k < rows; ++k) {
    for (int p = lower.start[k]; p < lower.start[k + 1]; ++p) {
      const int at = fill[before[p]]++;
      s.entry[at] = p;
      row_of_entry[at] = k;
    }
  }

  std::vector<int32_t> home(rows);
  for (int i = 0; i < count; ++i) std::fill(&home[s.first[i]], &home[s.first[i]] + s.columns(i), i);
  s.parent.assign(count, -1);
  s.row_start.assign(1, 0);
  std::vector<int32_t> mark(rows, -1), place(rows, 0), youngest(count, -1), next(count, -1);
  for (int i = 0; i < count; ++i) {
    const int from = s.first[i], end = s.first[i + 1];
    const auto add = [&](int row) {
      if (row < end || mark[row] == i) return;
      mark[row] = i;
      s.rows.push_back(row);
    };
    for (int p = s.column_start[from]; p < s.column_start[end]; ++p) add(row_of_entry[p]);
    for (int c = youngest[i]; c >= 0; c = next[c]) {
      for (int64_t r = s.row_start[c]; r < s.row_start[c + 1]; ++r) add(s.rows[r]);
    }
    std::sort(s.rows.begin() + s.row_start[i], s.rows.end());
    s.row_start.push_back(static_cast<int64_t>(s.rows.size()));
    for (int j = from; j < end; ++j) place[j] = j - from;
    for (int r = 0; r < s.below(i); ++r) place[s.rows[s.row_start[i] + r]] = end - from + r;
    for (int p = s.column_start[from]; p < s.column_start[end]; ++p) {
      s.entry_place[p] = place[row_of_entry[p]];
    }
    s.place.resize(s.rows.size());
    for (int c = youngest[i]; c >= 0; c = next[c]) {
      for (int64_t r = s.row_start[c]; r < s.row_start[c + 1]; ++r) s.place[r] = place[s.rows[r]];
    }
    if (s.below(i) == 0) continue;
    const int above = home[s.rows[s.row_start[i]]];
    s.parent[i] = above;
    next[i] = youngest[above];
    youngest[above] = i;
  }
  return s;
}

}  // namespace partuv
