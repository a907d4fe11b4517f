#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/job/job.h"

namespace patchlight {

/// One combination of swept values.
struct Variant {
  std::size_t grid = 0;                                       ///< Index into BenchConfig::sweep.
  std::vector<std::pair<std::string, std::string>> settings;  ///< Key and value, in the order of the grid's axes.
  std::string name;                                           ///< Of its folder; no two variants share one.
  std::string label;                                          ///< For people: `rays 64, patch_area 1e-3`.
};

/// Every combination of every grid, in order; the last axis runs fastest.
std::vector<Variant> bench_variants(const std::vector<SweepGrid>& sweep);

/// A key as people read it: its last word, or all of it where the sweep has two keys that end alike.
std::string short_key(const std::vector<SweepGrid>& sweep, const std::string& key);

/// What a measurement cost and how wrong it came out.
struct CostAndError {
  double seconds = 0;
  double error = 0;
};

/// The points than which no other is both as cheap and as right and better in one, by growing cost; points that are
/// equal are all on it. Points with a value that is not finite never are.
std::vector<std::size_t> pareto_front(const std::vector<CostAndError>& points);

}  // namespace patchlight
