#pragma once

/// Marks a function that is compiled twice, for plain x86-64 and for AVX2; the faster one is chosen
/// when the program is loaded. Neither reorders or fuses operations: both give the same bits. What
/// such a function calls has to be PARTUV_INLINE to be compiled with it.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PARTUV_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define PARTUV_WIDE
#endif

#if defined(__GNUC__)
#define PARTUV_INLINE inline __attribute__((always_inline))
#else
#define PARTUV_INLINE inline
#endif
