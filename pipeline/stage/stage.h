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

/// Options of every program.
struct CommonOptions {
  std::vector<std::string> sets;
  std::string output;
  int threads = 0;           ///< 0: all.
  std::uint64_t memory = 0;  ///< Memory limit of a stage, bytes; 0: the memory of the machine.
  bool quiet = false;
  std::string log_json;
};

Option job_argument(std::string& file);
Option job_argument(std::vector<std::string>& files);

/// Their command-line options.
std::vector<Option> common_options(CommonOptions& values);

/// Runs `body`; reports an exception as a message and returns its exit code, else 0.
int report_errors(const std::string& stage, Progress& progress, const std::function<void()>& body);

/// Runs `body` with a Progress made from the options; reports errors like report_errors().
int with_progress(const std::string& stage, const CommonOptions& options, const std::function<void(Progress&)>& body);

/// The provenance to store in an output: effective job, warnings, time and memory so far.
Provenance provenance(const Job& job, const Progress& progress);

/// The main function of a stage program: parses the options, reads the job, sets the number of threads, runs `body` and
/// reports its errors. `more`: additional options of the stage.
int run_stage(const std::string& stage, int argc, char** argv, const std::function<void(const Job&, Progress&)>& body,
              const std::vector<Option>& more = {});

}  // namespace patchlight
