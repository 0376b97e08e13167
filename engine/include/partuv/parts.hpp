#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/prior.hpp"
#include "partuv/simplify.hpp"
#include "partuv/solve.hpp"
#include "partuv/topology.hpp"
#include "partuv/tree.hpp"
#include "partuv/unwrap.hpp"

namespace partuv {

/// Part of each face of the surface as `Options::parts` asks for; empty where the parts are those
/// of the search. A built-in prior is cut as people would cut (`named_part_options`), on the
/// surface at full resolution, best without its noise; any other prior as the search sees it:
/// `tree`, over the proxy.
std::vector<int32_t> choose_parts(int parts, const PartPrior& prior, const Surface& surface,
                                  const Proxy& proxy, const PartTree& tree, const Context& context);

/// Every chart belongs to the part that most of its area lies in; the smaller number at a draw.
/// Nothing changes for empty `labels`.
void assign_parts(const Surface& surface, const std::vector<int32_t>& labels,
                  std::vector<SolvedChart>& charts);

/// Write the part of every face and chart into an assembled atlas, numbered without gaps by their
/// first faces: from `labels`, or else from the charts.
void write_parts(const Topology& topology, const std::vector<int32_t>& labels, Atlas& atlas);

}  // namespace partuv
