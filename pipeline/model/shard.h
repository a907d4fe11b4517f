#pragma once
#include <cstddef>

namespace patchlight {

/// Slurm's usual limit to the size of an array job.
constexpr int kMostShards = 1000;

/// One of several tasks that share a stage's work; by default, the only one.
struct Shard {
  int index = 1;  ///< From 1.
  int count = 1;

  /// Its part of `n` things in a row: from first() up to, but without, last().
  std::size_t first(std::size_t n) const { return n * std::size_t(index - 1) / std::size_t(count); }
  std::size_t last(std::size_t n) const { return n * std::size_t(index) / std::size_t(count); }
};

}  // namespace patchlight
