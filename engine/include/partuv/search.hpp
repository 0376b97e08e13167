#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/flatten.hpp"
#include "partuv/tree.hpp"

namespace partuv {

/// How the part tree is searched for charts.
struct SearchOptions {
  FlattenOptions flatten;          ///< bounds of a single chart
  double min_mean_angular = 0.95;  ///< bound on the mean over all faces, above a single chart's
  int most_normal_charts = 10;     ///< t of the paper: the Normal heuristic tries 1..t charts
  bool merge_heuristic = true;     ///< try Merge where Normal succeeded
  int least_merge_gain = 1;        ///< charts that Merge has to save where Normal succeeded
  bool recursion = true;           ///< look for a better combination below an accepted node
  bool final_merge = true;         ///< merge charts across parts afterwards
  bool cut_open = true;            ///< open closed and tubular pieces instead of rejecting them
  bool partial_weld = true;        ///< join charts along one run of their boundary if need be
  int fixed_parts = 0;             ///< nodes above that many parts are not tried; 0: all are
  int most_slits = 2;              ///< cuts to a peak of distortion that a chart may get
  int most_searches = 2;           ///< with stricter angles where their mean misses its bound
  double rounding_step = 0.0;  ///< of the grid on which maps will be written; 0: is not looked at
  /// Work of merging at full resolution, in faces looked at: near-linear in the size of the mesh.
  double merge_work_faces = 150e3, merge_work_per_face = 2.5;
};

/// A region of the surface that flattens within the bounds.
struct Chart {
  std::vector<int32_t> faces;  ///< ascending
  std::vector<int32_t> cuts;   ///< sides (half-edges, both of an edge) that stay open inside it
  int32_t part = -1;           ///< number of the part (accepted tree node) it belongs to
  double area_distortion = 1.0;
  double angular = 1.0;
};

using ChartSet = std::vector<Chart>;

/// PartTreeSearch (Algorithm 1 of the paper) on a surface. `weight` per face: how many of the
/// caller's faces it stands for. The charts cover every face. With a stopping context the rest is
/// left in pieces that no one has tried to flatten.
ChartSet search_charts(const Surface& surface, const PartTree& tree,
                       const std::vector<double>& weight, const SearchOptions& options,
                       Context& context);

}  // namespace partuv
