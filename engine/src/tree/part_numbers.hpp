#pragma once

#include <cstdint>
#include <vector>

namespace partuv {

/// Renumber labels (none negative) in the order of the first face that has them.
void number_by_first_face(std::vector<int32_t>& labels);

}  // namespace partuv
