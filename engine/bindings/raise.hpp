#pragma once

#include "partuv/error.hpp"

namespace partuv {

/// Throw partuv_engine.EngineError for a failure. Call with the GIL held.
[[noreturn]] void raise(const Failure& failure);

}  // namespace partuv
