#pragma once

#include <cstdint>
#include <vector>

#include "check.hpp"
#include "partuv/flatten.hpp"
#include "partuv/solve.hpp"

namespace partuv::test {

/// Faces that lie flat within the bounds, as a chart.
inline SolvedChart flat_chart(const Surface& s, const std::vector<int32_t>& faces,
                              const FlattenOptions& options) {
  Piece piece = extract_piece(s, faces, {});
  ConformalScale scale = predict_scale(piece, Context{});
  SolvedChart chart{flatten({std::move(piece), std::move(scale)}, options, Context{}), 0};
  CHECK(chart.flattening.within);
  return chart;
}

}  // namespace partuv::test
