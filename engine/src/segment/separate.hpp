#pragma once

#include <cstdint>
#include <vector>

#include "partuv/flatten.hpp"

namespace partuv {

/// Split a flattening that lies on itself between two patches that cover the same ground, along the
/// shortest seam (minimum cut). True for the faces on one side; empty if no two separate patches
/// overlap, or once the context is cancelled.
std::vector<char> separate_overlap(const Flattening& flattening, const Context& context);

/// What a region came to: flattenings within the bounds, and the faces of the source that have none
/// yet. Together they are the region, or both are empty.
struct Flattened {
  std::vector<Flattening> parts;
  std::vector<std::vector<int32_t>> left_over;  ///< connected, each ascending
};

/// Cut a flip-free flattening that lies on itself apart until no part does; parts lie where they
/// lay. Empty if no two patches can be told apart.
Flattened cut_apart(Flattening flattening, const FlattenOptions& options, const Context& context);

}  // namespace partuv
