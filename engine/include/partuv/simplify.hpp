#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/surface.hpp"

namespace partuv {

struct SimplifyOptions {
  int target_faces = 10000;  ///< stop at this many faces
  double max_error = 0.02;   ///< root mean square distance to leave the surface by, as a share of
                             ///< the square root of a component's area
};

/// A coarse stand-in for a surface, with the way back to it.
struct Proxy {
  Surface surface;
  /// For each face of the source the proxy face that stands for it: connected sets, near their
  /// proxy face over the surface and turned like it.
  std::vector<int32_t> proxy_of_face;
};

/// Quadric-error half-edge collapse (vertices of the proxy are vertices of the source) that keeps
/// the topology of every component, boundaries in place and creases sharp. Components of fewer than
/// 64 to 200 faces are kept as they are; when they are many the result exceeds the target. Needles
/// are removed where that costs nothing, below the target too. Near-linear time.
/// Empty once the context is cancelled.
Proxy simplify(const Surface& source, const SimplifyOptions& options, const Context& context);

}  // namespace partuv
