#pragma once
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Faults in the memory pages of the next `count` values in one system call, which is faster than one page fault per
/// page. The vector must have reserved them.
template <class Value>
void prefault(std::vector<Value>& values, std::size_t count) {
#ifdef MADV_POPULATE_WRITE
  const auto page = std::uintptr_t(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data() + values.size()) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(values.data() + values.size() + count) / page * page;
  if (begin < end)
    madvise(reinterpret_cast<void*>(begin), end - begin, MADV_POPULATE_WRITE);  // on failure pages fault in one by one
#endif
}

}  // namespace patchlight
