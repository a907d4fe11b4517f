#include "pipeline/job/job_check.h"

#include "pipeline/model/error.h"

namespace patchlight {

void check_available(const SolveConfig& solve) {
  if (solve.error_target > 0 && (solve.method != "matrix" || solve.form_factors != "rays"))
    throw Error(ExitCode::bad_config, "only `matrix` over `rays` can reach a target", "solve.error_target",
                "use them, or leave it out and raise solve.rays or solve.hemicube_resolution");
}

bool is_shardable(const SolveConfig& solve) {
  return solve.method == "matrix" && solve.form_factors == "rays" && solve.error_target == 0;
}

void check_shardable(const Job& job) {
  if (is_shardable(job.solve)) return;
  const char* key = job.solve.error_target > 0     ? "solve.error_target"
                    : job.solve.method != "matrix" ? "solve.method"
                                                   : "solve.form_factors";
  throw Error(ExitCode::bad_config, "only rows of `matrix` over `rays`, of a number that is given, come in shards",
              job.file.string() + ", " + key, "use them, or solve without --shard and --merge");
}

}  // namespace patchlight
