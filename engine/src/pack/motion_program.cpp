#include "pack/motion_program.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace partuv::packing {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;

/// Rows of the limits as products with the vector (3 per chart, then the growth).
class Rows {
 public:
  Rows(const std::vector<MotionLimit>& limits, int count) : limits_(limits), count_(count) {}

  int size() const { return static_cast<int>(limits_.size()); }
  int columns() const { return 3 * count_ + 1; }

  /// to = A x
  void multiply(const Vector& x, Vector& to) const {
    for (int k = 0; k < size(); ++k) {
      const MotionLimit& limit = limits_[k];
      double sum = limit.growth * x[columns() - 1];
      for (int i = 0; i < 3; ++i) sum += limit.a[i] * x[3 * limit.one + i];
      if (limit.two >= 0) {
        for (int i = 0; i < 3; ++i) sum += limit.b[i] * x[3 * limit.two + i];
      }
      to[k] = sum;
    }
  }

  /// to += A^T z
  void add_transposed(const Vector& z, Vector& to) const {
    for (int k = 0; k < size(); ++k) {
      const MotionLimit& limit = limits_[k];
      to[columns() - 1] += limit.growth * z[k];
      for (int i = 0; i < 3; ++i) to[3 * limit.one + i] += limit.a[i] * z[k];
      if (limit.two >= 0) {
        for (int i = 0; i < 3; ++i) to[3 * limit.two + i] += limit.b[i] * z[k];
      }
    }
  }

  const MotionLimit& operator[](int k) const { return limits_[k]; }

 private:
  const std::vector<MotionLimit>& limits_;
  int count_;
};

/// The lower half of A^T D A + diagonal. Where its numbers lie is found once: every column holds a
/// chart's own block, then the blocks with the higher charts it meets, then the growth's row.
class NormalMatrix {
 public:
  NormalMatrix(const Rows& rows, int count) : rows_(rows), count_(count) {
    for (int k = 0; k < rows.size(); ++k) {
      if (rows[k].two >= 0) pairs_.push_back(key(rows[k]));
    }
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    first_pair_.assign(count + 1, 0);
    for (const auto& [low, high] : pairs_) ++first_pair_[low + 1];
    for (int chart = 0; chart < count; ++chart) first_pair_[chart + 1] += first_pair_[chart];
    slot_.assign(rows.size(), -1);
    for (int k = 0; k < rows.size(); ++k) {
      if (rows[k].two < 0) continue;
      const auto at = std::lower_bound(pairs_.begin(), pairs_.end(), key(rows[k]));
      slot_[k] = static_cast<int>(at - pairs_.begin());
    }
    lay_out();
  }

  const Matrix& assemble(const Vector& weight, const Vector& diagonal) {
    double* values = matrix_.valuePtr();
    std::fill(values, values + matrix_.nonZeros(), 0.0);
    double& corner = values[matrix_.nonZeros() - 1];
    for (int column = 0; column < rows_.columns(); ++column) *own(column) = diagonal[column];
    for (int k = 0; k < rows_.size(); ++k) {
      const MotionLimit& limit = rows_[k];
      const double w = weight[k];
      add_chart(limit.one, limit.a, w, limit.growth);
      corner += w * limit.growth * limit.growth;
      if (limit.two < 0) continue;
      add_chart(limit.two, limit.b, w, limit.growth);
      const bool in_order = limit.one < limit.two;
      const int low = std::min(limit.one, limit.two);
      for (int j = 0; j < 3; ++j) {
        const double factor = w * (in_order ? limit.a[j] : limit.b[j]);
        double* block = own(3 * low + j) + (3 - j) + 3 * (slot_[k] - first_pair_[low]);
        for (int i = 0; i < 3; ++i) block[i] += factor * (in_order ? limit.b[i] : limit.a[i]);
      }
    }
    return matrix_;
  }

 private:
  const Rows& rows_;
  int count_;
  std::vector<std::pair<int, int>> pairs_;  // lower chart, higher chart
  std::vector<int> first_pair_;             // per lower chart, offsets into `pairs_`
  std::vector<int> slot_;                   // of each row, in `pairs_`
  Matrix matrix_;

  static std::pair<int, int> key(const MotionLimit& limit) {
    return std::minmax(limit.one, limit.two);
  }

  /// The entry on the diagonal, the first of its column.
  double* own(int column) { return matrix_.valuePtr() + matrix_.outerIndexPtr()[column]; }

  void add_chart(int chart, const std::array<double, 3>& row, double weight, double growth) {
    const int higher = first_pair_[chart + 1] - first_pair_[chart];
    for (int j = 0; j < 3; ++j) {
      double* column = own(3 * chart + j);
      const double factor = weight * row[j];
      for (int i = j; i < 3; ++i) column[i - j] += factor * row[i];
      column[3 - j + 3 * higher] += factor * growth;
    }
  }

  void lay_out() {
    const int columns = rows_.columns();
    matrix_.resize(columns, columns);
    matrix_.resizeNonZeros(9 * count_ + 9 * static_cast<int>(pairs_.size()) + 1);
    auto* start = matrix_.outerIndexPtr();
    auto* row = matrix_.innerIndexPtr();
    int at = 0;
    for (int chart = 0; chart < count_; ++chart) {
      for (int j = 0; j < 3; ++j) {
        start[3 * chart + j] = at;
        for (int i = j; i < 3; ++i) row[at++] = 3 * chart + i;
        for (int pair = first_pair_[chart]; pair < first_pair_[chart + 1]; ++pair) {
          for (int i = 0; i < 3; ++i) row[at++] = 3 * pairs_[pair].second + i;
        }
        row[at++] = columns - 1;
      }
    }
    start[columns - 1] = at;
    row[at++] = columns - 1;
    start[columns] = at;
  }
};

/// The largest share of a step, at most 1, that keeps every value positive.
double step_length(const Vector& value, const Vector& step) {
  double length = 1.0;
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    if (step[i] < 0.0) length = std::min(length, -value[i] / step[i]);
  }
  return length;
}

/// Slacks and multipliers of the limits and of both bounds of every variable.
struct Duals {
  Vector limit, low, high;
  double dot(const Duals& other) const {
    return limit.dot(other.limit) + low.dot(other.low) + high.dot(other.high);
  }
  double reach(const Duals& step) const {
    return std::min(step_length(limit, step.limit),
                    std::min(step_length(low, step.low), step_length(high, step.high)));
  }
  void advance(const Duals& step, double share) {
    limit += share * step.limit;
    low += share * step.low;
    high += share * step.high;
  }
};

}  // namespace

Motion solve_motion(const std::vector<MotionLimit>& limits, int count, double trust,
                    const Context& context) {
  Motion motion;
  const Rows rows(limits, count);
  const int n = rows.columns();
  const int m = rows.size();
  NormalMatrix normal(rows, count);
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower> solver;

  Vector least(m);
  for (int k = 0; k < m; ++k) least[k] = limits[k].least;
  Vector x = Vector::Zero(n);
  Duals slack{(-least).cwiseMax(0.05 * trust), Vector::Constant(n, trust),
              Vector::Constant(n, trust)};
  const double first_gap = 0.1;
  Duals price{first_gap * slack.limit.cwiseInverse(), first_gap * slack.low.cwiseInverse(),
              first_gap * slack.high.cwiseInverse()};
  Vector ax(m), dx(n), right(n), pull(m);
  Duals ds, dz;
  constexpr int most_steps = 40;
  for (int step = 0; step < most_steps && !context.stopping(); ++step) {
    rows.multiply(x, ax);
    const Vector primal = ax - slack.limit - least;
    Vector dual = -price.low + price.high;
    {
      Vector transposed = Vector::Zero(n);
      rows.add_transposed(price.limit, transposed);
      dual -= transposed;
      dual[n - 1] -= 1.0;  // the objective: maximise the growth
    }
    const double gap = slack.dot(price) / (m + 2.0 * n);
    if (gap * (m + 2.0 * n) < 1e-4 * trust && (m == 0 || primal.cwiseAbs().maxCoeff() < 1e-6)) {
      motion.solved = true;
      break;
    }
    const Vector weight = price.limit.cwiseQuotient(slack.limit);
    const Vector bounds = price.low.cwiseQuotient(slack.low) + price.high.cwiseQuotient(slack.high);
    ++motion.steps;
    const Matrix& matrix = normal.assemble(weight, bounds);
    if (step == 0) solver.analyzePattern(matrix);
    solver.factorize(matrix);
    if (solver.info() != Eigen::Success) break;

    // target: what slack * price changes by, to first order.
    auto direction = [&](const Duals& target) {
      right = target.low.cwiseQuotient(slack.low) - target.high.cwiseQuotient(slack.high) - dual;
      pull = (target.limit - price.limit.cwiseProduct(primal)).cwiseQuotient(slack.limit);
      rows.add_transposed(pull, right);
      dx = solver.solve(right);
      ds.limit.resize(m);
      rows.multiply(dx, ds.limit);
      ds.limit += primal;
      ds.low = dx;
      ds.high = -dx;
      dz.limit = (target.limit - price.limit.cwiseProduct(ds.limit)).cwiseQuotient(slack.limit);
      dz.low = (target.low - price.low.cwiseProduct(ds.low)).cwiseQuotient(slack.low);
      dz.high = (target.high - price.high.cwiseProduct(ds.high)).cwiseQuotient(slack.high);
    };
    Duals target{-slack.limit.cwiseProduct(price.limit), -slack.low.cwiseProduct(price.low),
                 -slack.high.cwiseProduct(price.high)};
    direction(target);
    Duals slack_try = slack;
    Duals price_try = price;
    slack_try.advance(ds, slack.reach(ds));
    price_try.advance(dz, price.reach(dz));
    const double gap_try = std::max(0.0, slack_try.dot(price_try)) / (m + 2.0 * n);
    const double centring = gap * std::pow(gap_try / gap, 3.0);
    target.limit.array() += centring - ds.limit.array() * dz.limit.array();
    target.low.array() += centring - ds.low.array() * dz.low.array();
    target.high.array() += centring - ds.high.array() * dz.high.array();
    direction(target);
    constexpr double keep_off = 0.995;
    const double primal_step = std::min(1.0, keep_off * slack.reach(ds));
    const double dual_step = std::min(1.0, keep_off * price.reach(dz));
    x += primal_step * dx;
    slack.advance(ds, primal_step);
    price.advance(dz, dual_step);
  }
  motion.growth = x[n - 1];
  motion.charts.resize(count);
  for (int i = 0; i < count; ++i) motion.charts[i] = {x[3 * i], x[3 * i + 1], x[3 * i + 2]};
  return motion;
}

}  // namespace partuv::packing
