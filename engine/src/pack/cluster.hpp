#pragma once

#include <vector>

#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// Charts laid out together, to be placed as one.
struct Cluster {
  std::vector<int> members;
  std::vector<Pose> poses;  ///< of the members around the outline's centre, in texels
  Outline outline;          ///< of all of them, in outline units
};

/// How a cluster is shown to the packer.
enum class Hull {
  outlines,   ///< the members' own, so that others may lie between them
  rectangle,  ///< the upright box around them
};

/// Lay out charts at a scale (texels per outline unit), the gutter apart, in the strip that gives
/// the smallest box. Without poses when no strip of the bin holds them.
Cluster make_cluster(const std::vector<Outline>& charts, std::vector<int> members, const Bin& bin,
                     int cells, double scale, Hull hull, const Context& context);

/// Where the members of clusters come to lie: `placed` are the clusters' poses, at a scale not
/// below the one they were made at.
Layout explode(const std::vector<Cluster>& clusters, size_t charts, double made_at,
               const Layout& placed);

}  // namespace partuv::packing
