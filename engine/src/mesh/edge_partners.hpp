#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "partuv/types.hpp"

namespace partuv::detail {

/// A side of a face at an edge.
struct EdgeSide {
  int32_t low, high;  ///< vertices of the edge
  int32_t apex;       ///< the face's third vertex
  int32_t side;       ///< half-edge
  bool upward;        ///< runs from low to high
};

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

/// Which sides at an edge of more than two meet, as pairs of half-edges that run in opposite
/// directions. Never a side and that of a copy of its own face (equal apex).
///
/// Two sides that alone have the same `numbers` at both ends meet: so the mesh says itself. Of the
/// others, by the first of these rules that links any:
///
/// 1. If there is one way only to pair all, that one. Of copies wound alike the first meets the
///    first.
/// 2. Where walls that begin and that end a solid alternate around the edge, those of one wedge of
///    solid meet.
/// 3. Sides that could meet no other but each other meet.
/// 4. Sides meet across which the surface goes on straightest.
///
/// `sides` is sorted by apex; `positions` belong to its vertices; `numbers` are the vertex numbers
/// that the caller's mesh has at the corners of each face, or empty.
Pairs edge_partners(std::vector<EdgeSide> sides, std::span<const Vec3> positions,
                    std::span<const Triangle> numbers);

}  // namespace partuv::detail
