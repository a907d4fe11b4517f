#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/provenance.h"
#include "pipeline/stage/command_line.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// What every program takes besides its job.
struct CommonOptions {
  std::vector<std::string> sets;
  std::string output;
  int threads = 0;           ///< 0: all.
  std::uint64_t memory = 0;  ///< Most bytes that a stage may take; 0: what the machine has.
  bool quiet = false;
  std::string log_json;
};

Option job_argument(std::string& file);
Option job_argument(std::vector<std::string>& files);

/// Options for them.
std::vector<Option> common_options(CommonOptions& values);

/// Runs `body` and turns whatever it throws into a message and an exit code of the contract.
int report_errors(const std::string& stage, Progress& progress, const std::function<void()>& body);

/// The same with a Progress made from the options.
int with_progress(const std::string& stage, const CommonOptions& options, const std::function<void(Progress&)>& body);

/// What a stage's output is to say of how it came to be, as far as it has come.
Provenance provenance(const Job& job, const Progress& progress);

/// The body of a stage program's main(): parses the options, reads the job, sets the number of threads, runs `body`
/// and reports its errors. `more`: options of the stage's own.
int run_stage(const std::string& stage, int argc, char** argv, const std::function<void(const Job&, Progress&)>& body,
              const std::vector<Option>& more = {});

}  // namespace patchlight
