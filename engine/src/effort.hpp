#pragma once

#include <limits>

#include "partuv/options.hpp"

namespace partuv {

/// What a quality stands for, stage by stage.
struct Effort {
  int proxy_faces = 7500;     ///< of the stand-in that charts are searched on
  int normal_charts = 6;      ///< most of them that Normal tries on a part
  bool recursion = false;     ///< look for a better combination below an accepted part
  int spread_steps = 8;       ///< to take a map that lies on itself apart
  bool full_polish = true;    ///< of the charts as delivered, beyond what the bounds ask for
  int patience = 5;           ///< of a flattening that fails at full resolution
  int searches = 2;           ///< where the mean angular score misses its bound at first
  double merging = 1.0;       ///< share of the usual work on merging at full resolution
  bool second_tree = false;   ///< search a tree of the normals too, where no tree is given
  bool deeper_slits = false;  ///< search again with more cuts per chart
  double packing = 0.2;       ///< share of the usual work on density
};

inline Effort effort_of(Quality quality) {
  Effort effort;
  if (quality == Quality::fast) {
    effort.proxy_faces = 3000;
    effort.spread_steps = 4;
    effort.full_polish = false;
    effort.patience = 1;
    effort.searches = 1;
    effort.merging = 0.0;
    effort.packing = 0.02;
  } else if (quality == Quality::best) {
    effort.proxy_faces = 10000;
    effort.normal_charts = 10;
    effort.recursion = true;
    effort.spread_steps = 24;
    effort.merging = std::numeric_limits<double>::infinity();
    effort.second_tree = effort.deeper_slits = true;
    effort.packing = 2.0;
  }
  return effort;
}

}  // namespace partuv
