#pragma once

#include <cstdint>
#include <vector>

#include "partuv/solve.hpp"
#include "segment/graft.hpp"

namespace partuv {

/// Flatten one region, opened along `cut_sides` or as it takes, and append the charts to `solved`.
/// It is split as often as it takes.
void solve_region(const Surface& surface, const std::vector<int32_t>& faces,
                  const std::vector<int32_t>& cut_sides, const SearchOptions& options,
                  const Context& context, std::vector<Flattening>& solved);

/// Charts that changed find new neighbours: merge them where the union still flattens. states: of
/// the charts as they come.
void rejoin(const Surface& surface, const std::vector<ChartState>& states,
            const SearchOptions& options, Context& context, std::vector<SolvedChart>& charts);

}  // namespace partuv
