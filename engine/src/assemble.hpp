#pragma once

#include <vector>

#include "partuv/lift.hpp"
#include "partuv/pack.hpp"
#include "partuv/search.hpp"
#include "partuv/simplify.hpp"
#include "partuv/solve.hpp"
#include "partuv/topology.hpp"
#include "partuv/unwrap.hpp"

namespace partuv {

/// Charts of the proxy as regions of the surface it stands for; weights: of its sides.
ChartSet lift_charts(const Surface& surface, const SideWeights& weights, const Proxy& proxy,
                     const ChartSet& charts, const Context& context);

/// Charts of more than one face that, as written, are out of bounds or have faces turned over
/// (needles lost to rounding).
std::vector<ChartExcess> charts_to_repair(const Topology& topology,
                                          const std::vector<SolvedChart>& solved,
                                          const Atlas& atlas, double least_area,
                                          double max_area_distortion);

/// Write the placed charts into the atlas, rounded to its grid, and measure what was written.
/// Faces outside of the surface get the coordinates of a neighbour's corners.
void assemble(const Mesh& mesh, const Topology& topology, const std::vector<SolvedChart>& solved,
              const Packing& packing, double least_area, Atlas& atlas);

}  // namespace partuv
