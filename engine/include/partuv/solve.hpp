#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/flatten.hpp"
#include "partuv/search.hpp"

namespace partuv {

/// A chart at full resolution: a valid flattening within the bounds, and the part it belongs to.
struct SolvedChart {
  Flattening flattening;
  int32_t part = 0;
};

/// Flatten regions of a surface for good. A region that fails at full resolution is split, and its
/// pieces are solved again; what cannot be flattened within the bounds ends in pieces that are
/// projected onto planes. The result is complete and valid whatever the input; once the context's
/// deadline has passed, what is left is projected.
std::vector<SolvedChart> solve_charts(const Surface& surface, const ChartSet& regions,
                                      const SearchOptions& options, Context& context);

/// Bring the mean angular score, over the caller's faces and all rotations of a chart, to
/// `options.min_mean_angular`: by polishing with less regard for area, which costs no chart, then
/// by splitting the charts that pull it down most. Polishing goes on beyond the bound up to a
/// reserve for steps that follow. Returns what was missing once all charts had been polished anew
/// for the first time.
double raise_mean_angular(const Surface& surface, const SearchOptions& options, Context& context,
                          std::vector<SolvedChart>& charts, double reserve = 0.0);

/// Sum of the angular scores of a chart's faces.
inline double angular_sum(const Flattening& flat) {
  return flat.piece.surface.face_count() * flat.distortion.angular;
}

/// Mean angular score of charts, over the caller's faces and all rotations of a chart.
double mean_angular(const std::vector<SolvedChart>& charts);

/// A chart that, as written in the atlas, is above the bound on area distortion or has faces turned
/// over.
struct ChartExcess {
  int32_t chart;
  double area_distortion;
  std::vector<int32_t> lost_faces;  ///< of the surface: rounding leaves them far from their area
};

/// Flatten charts anew with as much less distortion as rounding adds to them. Returns those for
/// which that cannot be had, and those that keep the bound.
std::vector<ChartExcess> tighten_charts(std::vector<ChartExcess> excesses,
                                        const SearchOptions& options, const Context& context,
                                        std::vector<SolvedChart>& charts);

/// Replace the given charts by two or more smaller ones each, which come last: what is lost to
/// rounding becomes charts of single faces; where nothing is, halves are solved again. With
/// `to_faces` all become single faces.
void split_charts(const Surface& surface, const std::vector<ChartExcess>& which,
                  const SearchOptions& options, bool to_faces, const Context& context,
                  std::vector<SolvedChart>& charts);

/// Cover connected faces with pieces that project onto planes within the area bound, without flip
/// or overlap: regions of like normals, single faces in the end.
std::vector<Flattening> project_to_planes(const Surface& surface, const std::vector<int32_t>& faces,
                                          const FlattenOptions& options);

}  // namespace partuv
