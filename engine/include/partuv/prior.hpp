#pragma once

#include <optional>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/error.hpp"
#include "partuv/simplify.hpp"
#include "partuv/topology.hpp"
#include "partuv/tree.hpp"

namespace partuv {

/// Where the part tree comes from: the built-in prior if both are empty.
struct PartPrior {
  std::vector<float> features;  ///< per face of the caller's mesh, `dimensions` values each
  int dimensions = 0;
  std::optional<PartTree> tree;  ///< over the faces of the caller's mesh
};

/// The part tree of a proxy. Features are averaged over the faces that a proxy face stands for, by
/// area, and clustered (Ward); a ready tree is restricted to one representative of each.
Result<PartTree> build_part_tree(const PartPrior& prior, const Topology& topology,
                                 const Proxy& proxy, const Context& context);

}  // namespace partuv
