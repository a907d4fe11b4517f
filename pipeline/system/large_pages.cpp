#include "pipeline/system/large_pages.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace patchlight {

void use_large_pages() {
#ifndef __SANITIZE_ADDRESS__  // which has a heap of its own
  constexpr std::uintptr_t kPage = std::uintptr_t(1) << 21;
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
  // A block that is advised, then freed untouched, leaves its addresses to the heap, and the advice with them.
  const std::size_t memory = std::size_t(sysconf(_SC_PHYS_PAGES)) * std::size_t(sysconf(_SC_PAGESIZE));
  void* const block = std::malloc(memory / 2);
  if (!block) return;
  const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(block) / kPage * kPage + kPage;
  madvise(reinterpret_cast<void*>(begin), memory / 2 - kPage, MADV_HUGEPAGE);
  std::free(block);
#endif
}

}  // namespace patchlight
