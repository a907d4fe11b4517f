#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace patchlight {

/// How an output was made. For information only: no result depends on it, and comparisons ignore it.
struct Provenance {
  std::string job;                    ///< The effective job as YAML, without output folder and bench.
  std::vector<std::string> warnings;  ///< Warnings of the stage.
  double wall_seconds = 0.0;          ///< Wall time of the stage's process up to writing the file.
  double cpu_seconds = 0.0;           ///< User and system time.
  std::int64_t peak_bytes = 0;        ///< Peak resident set size.
};

}  // namespace patchlight
