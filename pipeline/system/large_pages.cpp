#include "pipeline/system/large_pages.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace patchlight {

void use_large_pages() {
#ifndef __SANITIZE_ADDRESS__  // AddressSanitizer has its own heap
  constexpr std::uintptr_t kPageBytes = std::uintptr_t(1) << 21;
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
  // A block that is advised and freed untouched stays in the heap's address range and keeps the advice.
  const std::size_t memory = std::size_t(sysconf(_SC_PHYS_PAGES)) * std::size_t(sysconf(_SC_PAGESIZE));
  void* const block = std::malloc(memory / 2);
  if (!block) return;
  const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(block) / kPageBytes * kPageBytes + kPageBytes;
  madvise(reinterpret_cast<void*>(begin), memory / 2 - kPageBytes, MADV_HUGEPAGE);
  std::free(block);
#endif
}

}  // namespace patchlight
