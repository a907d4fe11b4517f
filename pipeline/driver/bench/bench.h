#pragma once
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct BenchCommand {
  std::string job_file;
  CommonOptions common;  ///< If `threads` is not set, the measured stages run on one thread.
};

/// Measures every variant of the job's `bench.sweep` against the reference; writes tables and pictures. Reports a
/// failed variant and continues. Returns the exit code of the first failed variant, else 0. Throws: Error (bad_config)
/// without a sweep; (unavailable) without gnuplot; (interrupted); errors of bench_reference().
int bench_job(const BenchCommand& command, Progress& progress);

}  // namespace patchlight
