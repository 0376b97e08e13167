#pragma once

#include <algorithm>

#include "partuv/context.hpp"

namespace partuv::detail {

/// Run body(i) for every i in [0, count), in chunks on the context's threads. Every i must write
/// its own results only.
template <typename Body>
void parallel_chunks(const Context& context, int count, Body&& body) {
  constexpr int chunk = 16384;
  parallel_for(context, (count + chunk - 1) / chunk, [&](int c) {
    for (int i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i) body(i);
  });
}

}  // namespace partuv::detail
