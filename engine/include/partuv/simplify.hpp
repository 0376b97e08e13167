#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/surface.hpp"

namespace partuv {

struct SimplifyOptions {
  int target_faces = 10000;      ///< stop at this many faces
  double max_error = 0.02;       ///< never leave the surface by more than this share of sqrt(area)
};

/// A coarse stand-in for a surface, with the way back to it.
struct Proxy {
  Surface surface;
  std::vector<int32_t> proxy_of_face;  ///< for each face of the source, the proxy face it belongs to
};

/// Quadric-error half-edge collapse (vertices of the proxy are vertices of the source) that keeps the
/// topology of every component, boundaries in place and creases sharp.
Proxy simplify(const Surface& source, const SimplifyOptions& options, const Context& context);

}  // namespace partuv
