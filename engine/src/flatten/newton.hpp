#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "flatten/elements.hpp"
#include "flatten/system.hpp"
#include "partuv/flatten.hpp"

namespace partuv {

/// Springs from vertices to points of the plane.
struct Springs {
  std::vector<int32_t> vertex;
  std::vector<Vec2> target;
  double stiffness = 0.0;
};

/// Projected Newton on the isotropic distortion energy of PolishOptions, with a barrier against
/// flips or without.
class Newton {
 public:
  /// Everything given must outlive the object.
  Newton(const Piece& piece, const std::vector<RestTriangle>& rest, const PolishOptions& options,
         const Context& context, MeshSystem<2>& system);

  /// Springs that add to the energy from now on.
  void attach(Springs springs) { springs_ = std::move(springs); }

  /// Energy of a map; infinite if a face is flipped and epsilon is 0.
  double energy(const std::vector<Vec2>& uv, double epsilon) const;
  /// The least determinant of a face's Jacobian.
  double least_determinant(const std::vector<Vec2>& uv) const;
  /// The step from `uv`; returns its slope, 0 where there is none.
  double direction(const std::vector<Vec2>& uv, double epsilon, std::vector<Vec2>& step);
  /// The longest part of a step, 1 at most, that flips no face.
  double safe_length(const std::vector<Vec2>& uv, const std::vector<Vec2>& step) const;
  /// Halve the step until it lowers the energy enough. The new energy; the old one if none does.
  double descend(std::vector<Vec2>& uv, const std::vector<Vec2>& step, double length, double slope,
                 double epsilon, double current) const;

 private:
  using Mat2 = Eigen::Matrix2d;

  /// The inverse of a rest triangle's edge matrix, and its share of the energy.
  struct Element {
    Mat2 inverse_rest;
    double weight;
  };

  ElementBatch batch_of(int number, const std::vector<Vec2>& uv) const;
  Mat2 jacobian(size_t f, const std::vector<Vec2>& uv) const;

  const std::vector<Triangle>& faces_;
  const PolishOptions& options_;
  const Context& context_;
  MeshSystem<2>& system_;
  std::vector<Element> elements_;
  Springs springs_;
  std::vector<BatchSystem> batches_;
  Eigen::VectorXd gradient_;
};

}  // namespace partuv
