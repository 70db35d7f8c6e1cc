#pragma once

// A function with this is compiled twice and chosen at run time by what the processor can do. There is no fused
// arithmetic in either, so both give the same bytes. Address sanitizer starts too late for such functions.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define LUMINAV_WIDE_VECTORS __attribute__((target_clones("avx2", "default"), flatten))
#else
#define LUMINAV_WIDE_VECTORS
#endif
