#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct BenchCommand {
  std::string job_file;
  CommonOptions common;  ///< Without `threads` the measured stages run on one.
};

/// Measures every variant of the job's `bench.sweep` against its reference and writes tables and pictures. A variant
/// that fails is reported and the others go on. Returns the exit code of the first that failed, else 0.
/// Throws: Error (bad_config) without a sweep, (unavailable) without gnuplot, (interrupted), and as bench_reference.
int bench_job(const BenchCommand& command, Progress& progress);

}  // namespace patchlight
