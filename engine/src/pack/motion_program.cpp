#include "pack/motion_program.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
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

/// The lower half of A^T D A + diagonal: the sparsity is found once, the values change.
class NormalMatrix {
 public:
  NormalMatrix(const Rows& rows, int count) : rows_(rows), count_(count) {
    for (int k = 0; k < rows.size(); ++k) {
      if (rows[k].two >= 0) pairs_.push_back(key(rows[k]));
    }
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    slot_.assign(rows.size(), -1);
    for (int k = 0; k < rows.size(); ++k) {
      if (rows[k].two < 0) continue;
      const auto at = std::lower_bound(pairs_.begin(), pairs_.end(), key(rows[k]));
      slot_[k] = static_cast<int>(at - pairs_.begin());
    }
    own_.resize(count);
    border_.resize(count);
    mixed_.resize(pairs_.size());
    matrix_.resize(rows.columns(), rows.columns());
  }

  const Matrix& assemble(const Vector& weight, const Vector& diagonal) {
    std::fill(own_.begin(), own_.end(), Eigen::Matrix3d::Zero());
    std::fill(border_.begin(), border_.end(), Eigen::Vector3d::Zero());
    std::fill(mixed_.begin(), mixed_.end(), Eigen::Matrix3d::Zero());
    double corner = diagonal[rows_.columns() - 1];
    for (int k = 0; k < rows_.size(); ++k) {
      const MotionLimit& limit = rows_[k];
      const Eigen::Vector3d a(limit.a[0], limit.a[1], limit.a[2]);
      own_[limit.one] += weight[k] * a * a.transpose();
      border_[limit.one] += weight[k] * limit.growth * a;
      corner += weight[k] * limit.growth * limit.growth;
      if (limit.two < 0) continue;
      const Eigen::Vector3d b(limit.b[0], limit.b[1], limit.b[2]);
      own_[limit.two] += weight[k] * b * b.transpose();
      border_[limit.two] += weight[k] * limit.growth * b;
      // Block (higher chart, lower chart), below the diagonal.
      mixed_[slot_[k]] += limit.one < limit.two ? Eigen::Matrix3d(weight[k] * b * a.transpose())
                                                : Eigen::Matrix3d(weight[k] * a * b.transpose());
    }
    triplets_.clear();
    for (int chart = 0; chart < count_; ++chart) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j <= i; ++j) {
          const double extra = i == j ? diagonal[3 * chart + i] : 0.0;
          triplets_.emplace_back(3 * chart + i, 3 * chart + j, own_[chart](i, j) + extra);
        }
        triplets_.emplace_back(3 * count_, 3 * chart + i, border_[chart][i]);
      }
    }
    for (size_t slot = 0; slot < pairs_.size(); ++slot) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          triplets_.emplace_back(3 * pairs_[slot].second + i, 3 * pairs_[slot].first + j,
                                 mixed_[slot](i, j));
        }
      }
    }
    triplets_.emplace_back(3 * count_, 3 * count_, corner);
    matrix_.setFromTriplets(triplets_.begin(), triplets_.end());
    return matrix_;
  }

 private:
  const Rows& rows_;
  int count_;
  std::vector<std::pair<int, int>> pairs_;  // lower chart, higher chart
  std::vector<int> slot_;                   // of each row, in `pairs_`
  std::vector<Eigen::Matrix3d> own_, mixed_;
  std::vector<Eigen::Vector3d> border_;
  std::vector<Eigen::Triplet<double>> triplets_;
  Matrix matrix_;

  static std::pair<int, int> key(const MotionLimit& limit) {
    return std::minmax(limit.one, limit.two);
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
  Vector ax(m);
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
    const Matrix& matrix = normal.assemble(weight, bounds);
    if (step == 0) solver.analyzePattern(matrix);
    solver.factorize(matrix);
    if (solver.info() != Eigen::Success) break;

    Vector dx(n);
    Duals ds, dz;
    // target: what slack * price changes by, to first order.
    auto direction = [&](const Duals& target) {
      Vector right =
          target.low.cwiseQuotient(slack.low) - target.high.cwiseQuotient(slack.high) - dual;
      const Vector pull =
          (target.limit - price.limit.cwiseProduct(primal)).cwiseQuotient(slack.limit);
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
