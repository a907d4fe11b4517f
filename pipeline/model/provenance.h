#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace patchlight {

/// How an output came to be. Nothing is computed from it, and no comparison looks at it.
struct Provenance {
  std::string job;                    ///< The whole effective job, YAML, without output folder and bench.
  std::vector<std::string> warnings;  ///< Of its stage.
  double wall_seconds = 0.0;          ///< Of the stage's process when it wrote this.
  double cpu_seconds = 0.0;           ///< User and system.
  std::int64_t peak_bytes = 0;        ///< Largest resident set.
};

}  // namespace patchlight
