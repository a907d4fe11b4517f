#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <vector>

#include "solver/linear/spectrum.h"

namespace patchlight {

/// Rows of one task, for any number of threads.
inline constexpr std::size_t kRowBlock = 1024;

/// Calls act(i) for every i below `count`.
template <class Act>
void for_each_row(std::size_t count, Act act) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (count + kRowBlock - 1) / kRowBlock), [&](const auto& range) {
    for (std::size_t i = range.begin() * kRowBlock; i < std::min(range.end() * kRowBlock, count); ++i) act(i);
  });
}

/// Sums the `kTerms` values that terms(i) returns over all i below `count`, in an order that does not depend on the
/// number of threads.
template <std::size_t kTerms, class Terms>
std::array<Spectrum, kTerms> sums_over_rows(std::size_t count, Terms terms) {
  std::vector<std::array<Spectrum, kTerms>> parts((count + kRowBlock - 1) / kRowBlock);
  tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t block) {
    std::array<Spectrum, kTerms> part;
    for (std::size_t i = block * kRowBlock; i < std::min((block + 1) * kRowBlock, count); ++i) {
      const std::array<Spectrum, kTerms> values = terms(i);
      for (std::size_t k = 0; k < kTerms; ++k) part[k] += values[k];
    }
    parts[block] = part;
  });
  std::array<Spectrum, kTerms> sums;
  for (const auto& part : parts)
    for (std::size_t k = 0; k < kTerms; ++k) sums[k] += part[k];
  return sums;
}

}  // namespace patchlight
