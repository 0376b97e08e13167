#pragma once

#include <cstdio>

namespace partuv::test {

/// How many checks of this executable have failed: its exit code.
inline int failures = 0;

inline void check(bool holds, const char* what, const char* file, int line) {
  if (holds) return;
  ++failures;
  std::fprintf(stderr, "%s:%d: %s\n", file, line, what);
}

}  // namespace partuv::test

/// Count and report a condition that does not hold, and go on.
#define CHECK(condition) ::partuv::test::check((condition), #condition, __FILE__, __LINE__)
