#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "partuv/ablation.hpp"
#include "partuv/context.hpp"
#include "partuv/error.hpp"
#include "partuv/options.hpp"
#include "partuv/pack.hpp"
#include "partuv/prior.hpp"
#include "partuv/types.hpp"

namespace partuv {

/// Figures of one chart of an atlas, measured on the coordinates as delivered.
struct ChartFigures {
  int32_t face_count = 0;
  int32_t part = 0;
  int32_t tile = 0;
  double area_3d = 0.0;          ///< in squared units of the caller's mesh
  double area_distortion = 1.0;  ///< Eq. 1 of the paper
  double angular = 1.0;          ///< mean angular score of the paper
};

/// The result: three UVs per input face, V up, in the unit square. Every coordinate is a multiple
/// of 2^-24 (of less with several tiles), so that it and its flip 1 - v are exact in single
/// precision wherever the tile lies in rows of ten.
struct Atlas {
  std::vector<float> corner_uv;  ///< F x 3 x 2
  std::vector<int32_t> chart;    ///< F
  std::vector<int32_t> part;     ///< F
  std::vector<int32_t> tile;     ///< F
  std::vector<ChartFigures> charts;
  std::vector<TileFigures> tiles;
  int32_t part_count = 0;
  double efficiency = 0.0;      ///< area of the charts over that of their square, mean of tiles
  double noise = 0.0;           ///< estimated noise of the surface
  int32_t proxy_faces = 0;      ///< faces of the surface that the search worked on
  int32_t searched_charts = 0;  ///< charts that the search found; more are delivered if some of
                                ///< them had to be split at full resolution
  std::vector<std::pair<std::string, double>> stage_seconds;
};

/// Unwrap a mesh. Deterministic: the same bytes for any number of threads.
Result<Atlas> unwrap(const Mesh& mesh, const PartPrior& prior, const Options& options,
                     Context& context, const Ablation& ablation = {});

}  // namespace partuv
