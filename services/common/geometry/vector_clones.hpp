#pragma once

// Before a function with loops over arrays: it is compiled for the widest vectors that the machine at hand may have,
// too, and the program takes what fits when it starts. Elsewhere, and under the sanitizers (which cannot run before the
// loader is done), there is only the plain one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define LUMINAV_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define LUMINAV_VECTOR_CLONES
#endif
