#pragma once

/// Compiles a function also for AVX2 and AVX-512; the version is selected by the processor when the program is loaded.
#ifdef __SANITIZE_ADDRESS__  // AddressSanitizer fails on function multiversioning at load time
#define VECTOR_CODE
#else
#define VECTOR_CODE __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
