#pragma once
#include <cstddef>

namespace patchlight {

/// Slurm's default limit for the size of an array job.
constexpr int kMaxShards = 1000;

/// One of `count` tasks that share the work of a stage; by default, the only one.
struct Shard {
  int index = 1;  ///< Counted from 1.
  int count = 1;

  /// The shard's part of `n` elements: [first, last).
  std::size_t first(std::size_t n) const { return n * std::size_t(index - 1) / std::size_t(count); }
  std::size_t last(std::size_t n) const { return n * std::size_t(index) / std::size_t(count); }
};

}  // namespace patchlight
