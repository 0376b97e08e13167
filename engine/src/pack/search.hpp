#pragma once

#include <vector>

#include "pack/layout.hpp"
#include "pack/polish.hpp"
#include "pack/tile.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// Search for a denser layout of a few hundred charts: several lanes, each with its own greedy
/// passes in shuffled orders to start from, then separations at growing scales, each tightened on
/// the outlines. Lanes run on the context's threads; what comes out does not depend on how many.
/// `rotations` are tried in the greedy passes. `effort` scales the work, which is counted, not
/// timed; 1 is about a third of a second on one core.
Layout search(const std::vector<Outline>& charts, const Bin& bin, const Polisher& polisher,
              const Layout& start, const TilePlan& plan, const Context& context);

}  // namespace partuv::packing
