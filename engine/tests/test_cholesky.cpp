// The sparse factorisation against Eigen's dense one.
#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "check.hpp"
#include "flatten/frontal_cholesky.hpp"
#include "flatten/ordering.hpp"
#include "flatten/system.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

VertexGraph random_graph(int vertices, double density, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<std::vector<int32_t>> neighbours(vertices);
  for (int i = 0; i < vertices; ++i) {
    for (int j = 0; j < i; ++j) {
      if (uniform(random) >= density) continue;
      neighbours[i].push_back(j);
      neighbours[j].push_back(i);
    }
    neighbours[i].push_back(i);
  }
  VertexGraph graph{{0}, {}};
  for (auto& own : neighbours) {
    std::sort(own.begin(), own.end());
    graph.other.insert(graph.other.end(), own.begin(), own.end());
    graph.first.push_back(static_cast<int32_t>(graph.other.size()));
  }
  return graph;
}

/// A sparse positive definite matrix in blocks, and the same one dense.
template <int D>
struct Sample {
  int rows;
  LowerPattern pattern;
  std::vector<double> diagonal, lower;
  Eigen::MatrixXd dense;

  Sample(const VertexGraph& graph, std::mt19937& random) : rows(graph.vertex_count()) {
    std::normal_distribution<double> deviate;
    dense = Eigen::MatrixXd::Zero(D * rows, D * rows);
    pattern = plan_elimination(graph).pattern;
    const auto& [start, before, parent] = pattern;
    for (int i = 0; i < rows; ++i) {
      for (int p = start[i]; p < start[i + 1]; ++p) {
        for (int r = 0; r < D; ++r) {
          for (int c = 0; c < D; ++c) {
            lower.push_back(deviate(random));
            dense(D * i + r, D * before[p] + c) = dense(D * before[p] + c, D * i + r) =
                lower.back();
          }
        }
      }
    }
    // Diagonal dominance makes it positive definite.
    const Eigen::VectorXd sums = dense.cwiseAbs().rowwise().sum();
    diagonal.assign(static_cast<size_t>(rows) * D * D, 0.0);
    for (int i = 0; i < rows; ++i) {
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) {
          const double value = r == c ? sums[D * i + r] + 2.0 : 0.5;
          diagonal[i * D * D + r * D + c] = dense(D * i + r, D * i + c) = value;
        }
      }
    }
  }
};

template <int D>
void test_against_dense() {
  std::mt19937 random(D);
  std::normal_distribution<double> deviate;
  for (const int rows : {1, 2, 5, 30, 90}) {
    for (const double density : {0.0, 0.05, 0.3, 1.0}) {
      const Sample<D> sample(random_graph(rows, density, random), random);
      FrontalCholesky<D> solver;
      solver.analyse(sample.pattern);
      Eigen::VectorXd rhs(D * rows);
      for (double& value : rhs) value = deviate(random);
      // A second factorisation with the same analysis must not see the first.
      for (int pass = 0; pass < 2; ++pass) {
        CHECK(solver.factor(sample.diagonal, sample.lower, Context()));
        Eigen::VectorXd x = rhs;
        solver.solve(x.data());
        CHECK((x - sample.dense.ldlt().solve(rhs)).norm() <= 1e-10 * rhs.norm());
      }
    }
  }
}

/// Cliques that hang together by one more: branches of the tree that are worth a thread each, and a
/// trunk.
VertexGraph cluster_graph(int cliques, int size, int joint) {
  const int rows = cliques * size + joint;
  const auto clique_of = [&](int i) { return i < joint ? -1 : (i - joint) / size; };
  VertexGraph graph{{0}, {}};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows; ++j) {
      if (clique_of(i) == clique_of(j) || i < joint || j < joint) graph.other.push_back(j);
    }
    graph.first.push_back(static_cast<int32_t>(graph.other.size()));
  }
  return graph;
}

/// What is worth it is done side by side: right, and to the bit the same as by one thread.
template <int D>
void test_threads() {
  std::mt19937 random(5);
  for (const VertexGraph& graph : {cluster_graph(9, 70, 40), cluster_graph(1, 400, 0)}) {
    const Sample<D> sample(graph, random);
    const Eigen::VectorXd rhs = Eigen::VectorXd::LinSpaced(D * sample.rows, -1.0, 2.0);
    std::vector<Eigen::VectorXd> found;
    for (const int threads : {1, 4}) {
      FrontalCholesky<D> solver;
      solver.analyse(sample.pattern);
      CHECK(solver.factor(sample.diagonal, sample.lower, Context(threads)));
      found.push_back(rhs);
      solver.solve(found.back().data());
    }
    CHECK(found[0] == found[1]);
    CHECK((sample.dense * found[0] - rhs).norm() <= 1e-9 * rhs.norm());
  }
}

template <int D>
void test_refusals() {
  std::mt19937 random(7);
  Sample<D> sample(random_graph(20, 0.2, random), random);
  FrontalCholesky<D> solver;
  solver.analyse(sample.pattern);
  Context context;
  context.cancel();
  CHECK(!solver.factor(sample.diagonal, sample.lower, context));
  for (int k = 0; k < D * D; ++k) sample.diagonal[11 * D * D + k] *= -1.0;
  CHECK(!solver.factor(sample.diagonal, sample.lower, Context()));
}

/// Values summed face by face give the system that the faces describe, whatever the ordering.
template <int D>
void test_mesh_system() {
  std::mt19937 random(3);
  std::normal_distribution<double> deviate;
  const Surface s = surface_of(sphere(2));
  const int n = s.vertex_count(), fixed = 5;
  std::vector<Triangle> faces = s.faces;
  std::vector<int32_t> unknown(n);
  for (int v = 0; v < n; ++v) unknown[v] = v < fixed ? -1 : v - fixed;
  for (Triangle& t : faces) {
    for (int& v : t) v = unknown[v];
  }
  MeshSystem<D> system(faces, n - fixed);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(D * (n - fixed), D * (n - fixed));
  for (size_t f = 0; f < faces.size(); ++f) {
    Eigen::MatrixXd root(3 * D, 3 * D);
    for (double& value : root.reshaped()) value = deviate(random);
    const Eigen::MatrixXd local = root * root.transpose();
    system.add(static_cast<int>(f), local);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (faces[f][i] < 0 || faces[f][j] < 0) continue;
        dense.block<D, D>(D * faces[f][i], D * faces[f][j]) += local.block<D, D>(D * i, D * j);
      }
    }
  }
  system.add_diagonal(3, D - 1, 2.0);
  dense(3 * D + D - 1, 3 * D + D - 1) += 2.0;
  CHECK(std::abs(system.mean_diagonal() - dense.diagonal().mean()) <= 1e-9);
  constexpr double shift = 0.1;
  CHECK(system.factor(shift, Context()));
  dense.diagonal().array() += shift;
  Eigen::VectorXd rhs(dense.rows());
  for (double& value : rhs) value = deviate(random);
  CHECK((dense * system.solve(rhs) - rhs).norm() <= 1e-9 * rhs.norm());
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  test_against_dense<1>();
  test_against_dense<2>();
  test_threads<1>();
  test_threads<2>();
  test_refusals<1>();
  test_refusals<2>();
  test_mesh_system<1>();
  test_mesh_system<2>();
  return failures;
}
