#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "partuv/pack.hpp"

namespace partuv {

/// What a chart may cost, and how it is flattened. Defaults and ranges are the contract's.
enum class Profile {
  balanced,   ///< ABF++ and a polish that trades a little angle for area: fewest charts
  conformal,  ///< ABF++ alone, as in the paper
};

enum class Flattener {
  abf,   ///< angle-based flattening
  lscm,  ///< least-squares conformal map
};

/// How much work an atlas may take.
enum class Quality {
  fast,      ///< a coarser stand-in, fewer ways to flatten a chart, a quick packing
  standard,  ///< one search; more work only where a bound asks for it
  best,      ///< searches of several part trees, never more charts than standard; longer packing
};

/// Words of `Options::parts`.
constexpr int searched_parts = -1, named_parts = 0;

/// Texel densities relative to others. A chart takes the largest weight of its faces, times that of
/// its part.
struct TexelWeights {
  std::vector<double> face;                      ///< of each face; empty: 1
  std::vector<std::pair<int32_t, double>> part;  ///< part number as in the atlas, weight
};

/// Options of an unwrap, with those of its packing; `texel_density` is per unit of the mesh.
struct Options : PackOptions {
  double max_area_distortion = 1.25;  ///< tau: bound on every chart's area distortion, above 1
  double min_angular = 0.95;          ///< bound on the atlas' mean angular score, in [0, 1)
  Profile profile = Profile::balanced;
  Flattener flattening = Flattener::abf;
  Quality quality = Quality::standard;
  double denoise = -1.0;  ///< strength of the denoised copy; 0 is off, below 0 automatic
  /// A chart that alone would keep the efficiency of the atlas below this is cut in two where that
  /// helps; 0: none is.
  double cut_below_efficiency = 0.47;
  /// What faces and charts are parts of: the tree nodes that the search accepted, as many parts as
  /// people are likely to name, or that many.
  int parts = searched_parts;
  TexelWeights texel_weights;
};

}  // namespace partuv
