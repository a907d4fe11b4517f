#pragma once
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Has the system give the memory of the next `count` values, which must be reserved, all at once, which takes less
/// time than page by page as they are first touched.
template <class Value>
void prefault(std::vector<Value>& values, std::size_t count) {
#ifdef MADV_POPULATE_WRITE
  const auto page = std::uintptr_t(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data() + values.size()) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(values.data() + values.size() + count) / page * page;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_POPULATE_WRITE);  // or it is slower
#endif
}

}  // namespace patchlight
