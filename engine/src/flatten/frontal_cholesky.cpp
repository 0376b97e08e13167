#include "flatten/frontal_cholesky.hpp"

#include <algorithm>

#include "flatten/dense_cholesky.hpp"

namespace partuv {

template <int D>
int64_t FrontalCholesky<D>::update_size(int s) const {
  const int64_t size = static_cast<int64_t>(D) * tree_.below(s);
  return size * size;
}

template <int D>
void FrontalCholesky<D>::find_branches() {
  const int count = tree_.count();
  std::vector<double> work(count, 0.0);  // multiplications for a supernode and all below it
  double all = 0.0;
  for (int s = 0; s < count; ++s) {
    const double high = height(s);
    work[s] += D * tree_.columns(s) * high * high;
    (tree_.parent[s] >= 0 ? work[tree_.parent[s]] : all) += work[s];
  }
  constexpr double worth_a_thread = 1e6;
  const double most = std::max(all / 8.0, worth_a_thread);
  const auto in_trunk = [&](int s) { return work[s] > most; };
  branches_.clear();
  trunk_.clear();
  handed_.clear();
  int32_t first = 0;
  double held = 0.0;
  const auto close = [&](int32_t end) {
    if (end > first) branches_.push_back({first, end, 0});
    first = end;
    held = 0.0;
  };
  for (int s = 0; s < count; ++s) {
    const int above = tree_.parent[s];
    if (in_trunk(s)) {
      close(s);
      first = s + 1;
      trunk_.push_back(s);
    } else if (above < 0 || in_trunk(above)) {
      if (above >= 0) handed_.push_back(s);
      held += work[s];
      if (held > most) close(s + 1);
    }
  }
  close(count);
  std::stable_sort(handed_.begin(), handed_.end(),
                   [&](int a, int b) { return tree_.parent[a] < tree_.parent[b]; });
}

template <int D>
void FrontalCholesky<D>::lay_out_stack() {
  // A supernode's update is made above those of its children, then takes their place.
  std::vector<int64_t> children(tree_.count(), 0);
  int64_t base = 0, top = 0, highest = 0;
  const auto put = [&](int s, bool parent_too) {
    highest = std::max(highest, top + update_size(s));
    top += update_size(s) - children[s];
    if (parent_too) children[tree_.parent[s]] += update_size(s);
  };
  const auto finish = [&] {
    base += highest;
    top = highest = 0;
  };
  for (Branch& branch : branches_) {
    branch.stack = base;
    for (int s = branch.first; s < branch.end; ++s) {
      put(s, tree_.parent[s] >= 0 && tree_.parent[s] < branch.end);
    }
    finish();
  }
  trunk_stack_ = base;
  for (const int s : trunk_) put(s, tree_.parent[s] >= 0);
  finish();
  stack_.resize(base);
  update_at_.resize(tree_.count());
}

template <int D>
void FrontalCholesky<D>::analyse(const LowerPattern& pattern) {
  tree_ = find_supernodes(pattern);
  panel_start_.assign(1, 0);
  for (int s = 0; s < tree_.count(); ++s) {
    panel_start_.push_back(panel_start_.back() +
                           static_cast<int64_t>(height(s)) * D * tree_.columns(s));
  }
  panel_.resize(panel_start_.back());
  find_branches();
  lay_out_stack();
}

template <int D>
void FrontalCholesky<D>::assemble_entries(int s, const std::vector<double>& diagonal,
                                          const std::vector<double>& lower) {
  const int64_t high = height(s);
  double* const panel = &panel_[panel_start_[s]];
  std::fill(panel, &panel_[panel_start_[s + 1]], 0.0);
  const auto add = [&](int row, int column, const double* block) {
    double* const at = panel + D * column * high + D * row;
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) at[c * high + r] += block[r * D + c];
    }
  };
  for (int j = tree_.first[s]; j < tree_.first[s + 1]; ++j) {
    const int column = j - tree_.first[s];
    add(column, column, &diagonal[static_cast<size_t>(j) * D * D]);
    for (int p = tree_.column_start[j]; p < tree_.column_start[j + 1]; ++p) {
      add(tree_.entry_place[p], column, &lower[static_cast<size_t>(tree_.entry[p]) * D * D]);
    }
  }
}

template <int D>
void FrontalCholesky<D>::assemble_child(int child, int parent, double* parent_update) {
  const double* const update = stack_.data() + update_at_[child];
  const int size = tree_.below(child), own = tree_.columns(parent);
  const int32_t* const place = &tree_.place[tree_.row_start[child]];
  const int64_t high = height(parent), wide = static_cast<int64_t>(D) * tree_.below(parent);
  for (int c = 0; c < size; ++c) {
    const bool inside = place[c] < own;
    for (int q = 0; q < D; ++q) {
      const double* const from = update + (static_cast<int64_t>(D) * c + q) * D * size;
      // An update starts with the first row below the parent's own.
      const int first = inside ? 0 : own;
      double* const to = inside ? &panel_[panel_start_[parent]] + (D * place[c] + q) * high
                                : parent_update + (D * (place[c] - own) + q) * wide;
      for (int r = c; r < size; ++r) {
        for (int t = 0; t < D; ++t) to[D * (place[r] - first) + t] += from[D * r + t];
      }
    }
  }
}

template <int D>
bool FrontalCholesky<D>::eliminate(int s, const std::vector<double>& diagonal,
                                   const std::vector<double>& lower,
                                   std::span<const int32_t> others, Waiting& waiting,
                                   const Context& context) {
  const int own = D * tree_.columns(s), size = D * tree_.below(s), high = own + size;
  double* const panel = &panel_[panel_start_[s]];
  double* const update = stack_.data() + waiting.top;
  std::fill_n(update, update_size(s), 0.0);
  assemble_entries(s, diagonal, lower);
  for (const int child : others) assemble_child(child, s, update);
  std::vector<int32_t>& below = waiting.supernodes;
  for (; !below.empty() && tree_.parent[below.back()] == s; below.pop_back()) {
    assemble_child(below.back(), s, update);
    waiting.top = update_at_[below.back()];
  }
  if (!factor_columns(panel, high, own, context)) return false;
  if (size == 0) return true;
  subtract_square(update, size, panel + own, high, own, context);
  update_at_[s] = waiting.top;
  std::copy_n(update, update_size(s), stack_.data() + waiting.top);
  waiting.top += update_size(s);
  below.push_back(s);
  return true;
}

template <int D>
bool FrontalCholesky<D>::factor(const std::vector<double>& diagonal,
                                const std::vector<double>& lower, const Context& context) {
  const bool branched = parallel_all(context, static_cast<int>(branches_.size()), [&](int b) {
    Waiting waiting{{}, branches_[b].stack};
    for (int s = branches_[b].first; s < branches_[b].end; ++s) {
      if (context.cancelled() || !eliminate(s, diagonal, lower, {}, waiting, context)) return false;
    }
    return true;
  });
  if (!branched) return false;
  Waiting waiting{{}, trunk_stack_};
  auto handed = handed_.begin();
  for (const int s : trunk_) {
    if (context.cancelled()) return false;
    const auto from = handed;
    while (handed != handed_.end() && tree_.parent[*handed] == s) ++handed;
    if (!eliminate(s, diagonal, lower, {from, handed}, waiting, context)) return false;
  }
  return !context.cancelled();
}

template <int D>
void FrontalCholesky<D>::solve(double* x) const {
  std::vector<double> rest;
  for (int s = 0; s < tree_.count(); ++s) {
    const int own = D * tree_.columns(s), size = D * tree_.below(s);
    const int32_t* const rows = tree_.rows.data() + tree_.row_start[s];
    rest.resize(size);
    solve_forward(&panel_[panel_start_[s]], own + size, own,
                  x + static_cast<int64_t>(D) * tree_.first[s], rest.data());
    for (int i = 0; i < size; ++i) x[static_cast<int64_t>(D) * rows[i / D] + i % D] -= rest[i];
  }
  for (int s = tree_.count() - 1; s >= 0; --s) {
    const int own = D * tree_.columns(s), size = D * tree_.below(s);
    const int32_t* const rows = tree_.rows.data() + tree_.row_start[s];
    rest.resize(size);
    for (int i = 0; i < size; ++i) rest[i] = x[static_cast<int64_t>(D) * rows[i / D] + i % D];
    solve_backward(&panel_[panel_start_[s]], own + size, own,
                   x + static_cast<int64_t>(D) * tree_.first[s], rest.data());
  }
}

template class FrontalCholesky<1>;
template class FrontalCholesky<2>;

}  // namespace partuv
