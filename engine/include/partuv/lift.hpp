#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/simplify.hpp"
#include "partuv/surface.hpp"

namespace partuv {

struct LiftOptions {
  double band_edges = 1.0;  ///< how far a boundary may move to get straight, in mean proxy edges
};

/// What a boundary costs along each side of each face, and the sides that count as creases.
struct SideWeights {
  std::vector<std::array<float, 3>> cost;
  std::vector<std::array<uint8_t, 3>> crease;
};

/// noise: of the surface; see `estimate_noise`.
SideWeights weigh_sides(const Surface& surface, double noise, const Context& context);

/// Labels of the source's faces from labels (0 .. labels - 1) of the proxy's: connected sets of the
/// proxy chart's topology, with short boundaries that keep to creases and to concave edges.
/// A label that the proxy has does not vanish. weights: of the source. Near-linear time.
std::vector<int32_t> lift_labels(const Surface& source, const SideWeights& weights,
                                 const Proxy& proxy,
                                 const std::vector<int32_t>& label_of_proxy_face,
                                 const LiftOptions& options, const Context& context);

/// Shorten the boundaries between labelled regions of a surface, each moving by `band` at most.
/// Regions keep their topology; boundaries that lie on a crease stay there.
void straighten_labels(const Surface& surface, const SideWeights& weights, double band,
                       std::vector<int32_t>& label, const Context& context);

}  // namespace partuv
