#pragma once

#include <cstdint>
#include <vector>

#include "partuv/flatten.hpp"

namespace partuv {

/// Split a flattening that lies on itself between two patches that cover the same ground, along the
/// shortest seam (minimum cut). True for the faces on one side; empty if no two separate patches
/// overlap, or once the context is cancelled.
std::vector<char> separate_overlap(const Flattening& flattening, const Context& context);

/// Cut a flip-free flattening that lies on itself apart until no part does; parts lie where they
/// lay. What comes back keeps the bounds; the rest goes to `left_over`, as faces of the source.
/// Nothing in either if no two patches can be told apart.
std::vector<Flattening> cut_apart(const Flattening& flattening, const FlattenOptions& options,
                                  const Context& context,
                                  std::vector<std::vector<int32_t>>& left_over);

}  // namespace partuv
