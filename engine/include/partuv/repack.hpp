#pragma once

#include <cstdint>
#include <vector>

#include "partuv/pack.hpp"
#include "partuv/types.hpp"

namespace partuv {

/// Charts that are there already: triangles over points, with the chart of each triangle.
struct FlatMesh {
  std::vector<Vec2> uv;
  std::vector<Triangle> faces;  ///< indices into `uv`
  std::vector<int32_t> chart;   ///< of each face, from 0
  std::vector<int32_t> part;    ///< of each chart; empty: all one part
  std::vector<double> weight;   ///< texel density of each chart relative to others; empty: 1
};

struct Repacked {
  Packing packing;               ///< places of the charts
  std::vector<float> corner_uv;  ///< F x 3 x 2, in each face's tile
};

/// Pack given charts anew. Mirrored charts stay mirrored. Fails like `pack`, and on coordinates,
/// indices or lengths that make no sense.
Result<Repacked> repack(const FlatMesh& mesh, const PackOptions& options, const Context& context);

}  // namespace partuv
