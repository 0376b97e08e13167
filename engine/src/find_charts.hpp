#pragma once

#include <vector>

#include "partuv/lift.hpp"
#include "partuv/search.hpp"
#include "partuv/simplify.hpp"
#include "partuv/solve.hpp"
#include "stages.hpp"

namespace partuv {

/// The surface that the search works on, and what it takes to carry charts over from it.
struct StandIn {
  Proxy proxy;
  bool exact = false;        ///< the proxy is the very surface
  SideWeights side_weights;  ///< of the surface itself; none where the proxy is exact
};

/// How far a single chart may lie from conformal, as a share of how far the mean may.
constexpr double loosest_share = 1.6;

/// The angular bound of a single chart.
inline double chart_angular(const SearchOptions& options, double share) {
  return 1.0 - share * (1.0 - options.min_mean_angular);
}

/// Search the stand-in along each tree with each of the options and solve what is found on the
/// surface. Of several searches every component of the surface takes the one with the fewest charts
/// in it. searched_charts: how many charts the first search found, before they were solved.
std::vector<SolvedChart> find_charts(const Surface& surface, const StandIn& stand_in,
                                     const std::vector<PartTree>& trees,
                                     const std::vector<SearchOptions>& searches, Stages& stages,
                                     Context& context, int32_t& searched_charts);

}  // namespace partuv
