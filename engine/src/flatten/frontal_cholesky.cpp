#include "flatten/frontal_cholesky.hpp"

#include <algorithm>

#include "flatten/dense_cholesky.hpp"

namespace partuv {

template <int D>
void FrontalCholesky<D>::analyse(const LowerPattern& pattern) {
  tree_ = find_supernodes(pattern);
  panel_start_.assign(1, 0);
  // Updates lie on a stack: a supernode's is made above those of its children, then takes their
  // place.
  std::vector<int64_t> children(tree_.count(), 0);
  int64_t top = 0, highest = 0;
  for (int s = 0; s < tree_.count(); ++s) {
    panel_start_.push_back(panel_start_.back() +
                           static_cast<int64_t>(height(s)) * D * tree_.columns(s));
    const int64_t size = static_cast<int64_t>(D) * tree_.below(s), square = size * size;
    highest = std::max(highest, top + square);
    top += square - children[s];
    if (tree_.parent[s] >= 0) children[tree_.parent[s]] += square;
  }
  panel_.resize(panel_start_.back());
  stack_.resize(highest);
}

template <int D>
void FrontalCholesky<D>::assemble_entries(int s, const std::vector<double>& diagonal,
                                          const std::vector<double>& lower) {
  const int64_t high = height(s);
  double* const panel = &panel_[panel_start_[s]];
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
void FrontalCholesky<D>::assemble_child(int child, const double* update, int parent,
                                        double* parent_update) {
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
bool FrontalCholesky<D>::factor(const std::vector<double>& diagonal,
                                const std::vector<double>& lower, const Context& context) {
  std::fill(panel_.begin(), panel_.end(), 0.0);
  std::vector<int32_t> waiting;  // supernodes whose updates lie on the stack
  int64_t top = 0;
  for (int s = 0; s < tree_.count(); ++s) {
    if (context.cancelled()) return false;
    const int own = D * tree_.columns(s), size = D * tree_.below(s), high = own + size;
    double* const panel = &panel_[panel_start_[s]];
    double* const update = stack_.data() + top;
    std::fill_n(update, static_cast<int64_t>(size) * size, 0.0);
    assemble_entries(s, diagonal, lower);
    int64_t bottom = top;
    while (!waiting.empty() && tree_.parent[waiting.back()] == s) {
      const int64_t wide = static_cast<int64_t>(D) * tree_.below(waiting.back());
      bottom -= wide * wide;
      assemble_child(waiting.back(), stack_.data() + bottom, s, update);
      waiting.pop_back();
    }
    if (!factor_columns(panel, high, own)) return false;
    if (size == 0) {
      top = bottom;
      continue;
    }
    subtract_square(update, size, panel + own, high, own);
    std::copy_n(update, static_cast<int64_t>(size) * size, stack_.data() + bottom);
    top = bottom + static_cast<int64_t>(size) * size;
    waiting.push_back(s);
  }
  return true;
}

template <int D>
void FrontalCholesky<D>::solve(double* x) const {
  std::vector<double> rest;
  for (int s = 0; s < tree_.count(); ++s) {
    const int own = D * tree_.columns(s), size = D * tree_.below(s), high = own + size;
    double* const xs = x + static_cast<int64_t>(D) * tree_.first[s];
    const int32_t* const rows = tree_.rows.data() + tree_.row_start[s];
    rest.assign(size, 0.0);
    for (int j = 0; j < own; ++j) {
      const double* const column = &panel_[panel_start_[s] + static_cast<int64_t>(j) * high];
      xs[j] /= column[j];
      for (int i = j + 1; i < own; ++i) xs[i] -= column[i] * xs[j];
      for (int i = 0; i < size; ++i) rest[i] += column[own + i] * xs[j];
    }
    for (int i = 0; i < size; ++i) x[static_cast<int64_t>(D) * rows[i / D] + i % D] -= rest[i];
  }
  for (int s = tree_.count() - 1; s >= 0; --s) {
    const int own = D * tree_.columns(s), size = D * tree_.below(s), high = own + size;
    double* const xs = x + static_cast<int64_t>(D) * tree_.first[s];
    const int32_t* const rows = tree_.rows.data() + tree_.row_start[s];
    rest.resize(size);
    for (int i = 0; i < size; ++i) rest[i] = x[static_cast<int64_t>(D) * rows[i / D] + i % D];
    for (int j = own - 1; j >= 0; --j) {
      const double* const column = &panel_[panel_start_[s] + static_cast<int64_t>(j) * high];
      double sum = xs[j];
      for (int i = j + 1; i < own; ++i) sum -= column[i] * xs[i];
      for (int i = 0; i < size; ++i) sum -= column[own + i] * rest[i];
      xs[j] = sum / column[j];
    }
  }
}

template class FrontalCholesky<1>;
template class FrontalCholesky<2>;

}  // namespace partuv
