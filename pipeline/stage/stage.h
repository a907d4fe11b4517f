#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/provenance.h"
#include "pipeline/model/shard.h"
#include "pipeline/stage/progress.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

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

/// As `--version` prints it.
std::string patchlight_version();

void add_common_options(CLI::App& app, CommonOptions& options);

/// Adds `--shard k/K`.
CLI::Option* add_shard_option(CLI::App& app, std::optional<Shard>& shard, const std::string& help);

/// Parses a command line; an exit code if the program is to end at once (help, version, wrong usage).
std::optional<int> parse_options(CLI::App& app, const std::string& name, int argc, char** argv);

/// Runs `body` and turns whatever it throws into a message and an exit code of the contract.
int report_errors(const std::string& stage, Progress& progress, const std::function<void()>& body);

/// The same with a Progress made from the options.
int with_progress(const std::string& stage, const CommonOptions& options, const std::function<void(Progress&)>& body);

/// What a stage's output is to say of how it came to be, as far as it has come.
Provenance provenance(const Job& job, const Progress& progress);

/// The body of a stage program's main(): parses the options, reads the job, sets the number of threads, runs `body`
/// and reports its errors. `more` adds options of the stage's own.
int run_stage(const std::string& stage, int argc, char** argv, const std::function<void(const Job&, Progress&)>& body,
              const std::function<void(CLI::App&)>& more = {});

}  // namespace patchlight
