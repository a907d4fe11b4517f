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
  std::string name;                                           ///< Name of its folder; unique.
  std::string label;                                          ///< For display: `rays 64, patch_area 1e-3`.
};

/// Every combination of every grid, in order; the last axis runs fastest.
std::vector<Variant> bench_variants(const std::vector<SweepGrid>& sweep);

/// The last word of a key for display, or the whole key if two swept keys have the same last word.
std::string short_key(const std::vector<SweepGrid>& sweep, const std::string& key);

/// Cost and error of a measurement.
struct CostAndError {
  double seconds = 0;
  double error = 0;
};

/// Indices of the points that no other point dominates in cost and error, by increasing cost. Equal points are all on
/// the front; points with a value that is not finite are not.
std::vector<std::size_t> pareto_front(const std::vector<CostAndError>& points);

}  // namespace patchlight
