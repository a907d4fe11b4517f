#pragma once

/// Marks a function to be compiled for AVX2 and AVX-512 too and chosen by the processor when the program loads.
#ifdef __SANITIZE_ADDRESS__  // cannot start programs that choose functions while they load
#define VECTOR_CODE
#else
#define VECTOR_CODE __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
