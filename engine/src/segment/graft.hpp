#pragma once

#include <vector>

#include "partuv/search.hpp"
#include "partuv/solve.hpp"

namespace partuv {

/// What became of a chart's region at full resolution.
enum class ChartState : char {
  settled,   ///< solved as it was found
  changed,   ///< lost or gained faces
  fragment,  ///< a piece that fell off
};

/// Let fragments grow onto their neighbours: a fragment is laid beside the seam and polished
/// together with the few rings of faces around it, while the rest of the neighbour stays where it
/// lies. Costs a fraction of flattening the union. Fragments that found a host leave both lists.
void graft_fragments(const Surface& surface, const SearchOptions& options, const Context& context,
                     std::vector<SolvedChart>& charts, std::vector<ChartState>& states);

/// What small charts that hang on others may cost of the mean angular score.
constexpr double hanging_angular_cost = 0.003;

/// Join small charts, up to about a tenth of the texture wide, to neighbours of more area, as
/// fragments are or by a part of the common boundary: those too thin for a texture if only by one
/// side, and to neighbours of less area, too. What no neighbour can take in within the bounds
/// stays; if it is too thin for a texture, it takes faces over from one.
void hang_small_charts(const Surface& surface, const SearchOptions& options, const Context& context,
                       std::vector<SolvedChart>& charts);

/// The same for those alone that are too thin for a texture, of the charts from `first` on.
void hang_slivers(const Surface& surface, const SearchOptions& options, const Context& context,
                  size_t first, std::vector<SolvedChart>& charts);

}  // namespace partuv
