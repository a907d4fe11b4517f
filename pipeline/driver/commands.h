#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct RunCommand {
  std::string job_file;
  bool force = false;
  CommonOptions common;
  std::string last_stage = "trace";
  bool explain = false;           ///< Say all reasons, also those not to run.
  std::filesystem::path cache{};  ///< Where outputs of earlier settings are kept; empty: in the job's own output.
};

/// Starts the stages whose outputs do not match the job, in order, and says why; what was made before with the same
/// settings is put back instead. Returns the exit code of the first stage that fails, else 0. `account`, unless null:
/// is told what each stage did, in a few words.
int run_job(const RunCommand& command, Progress& progress, std::string* account = nullptr);

struct BatchCommand {
  std::vector<std::string> job_files;
  std::string variant;  ///< Glob; empty: all.
  bool force = false;
  bool explain = false;
  CommonOptions common;
};

/// Runs all variants of all jobs, on past those that fail, and sums up. Returns the exit code of the first failure,
/// else 0. Throws: Error (usage) for one output folder of several jobs, (interrupted).
int run_jobs(const BatchCommand& command, Progress& progress);

struct CleanCommand {
  std::string job_file;
  bool all = false;  ///< Also what stands in the output folder.
  CommonOptions common;
};

/// Removes outputs of earlier settings that a job keeps, and says how much room that made. Returns 0.
/// Throws: Error (bad_config, missing_input) for the job, (io_error).
int clean_job(const CleanCommand& command, Progress& progress);

struct StatusCommand {
  std::vector<std::string> job_files;
  std::string variant;  ///< Glob; empty: all.
  CommonOptions common;
};

/// Prints a line for each stage and frame of all variants of all jobs: fresh, stale, missing or damaged, and why;
/// nothing is run or changed. Returns 0 if all is fresh, else 1. Throws: Error (bad_config, missing_input) for the job.
int show_status(const StatusCommand& command);

struct PreviewCommand {
  std::string job_file;
  std::string kind = "patches";
  std::string camera;
  std::string patch;
  CommonOptions common;
};

/// Draws a picture of a job's patches, radiosity or hemicubes into <output>/preview/, after running what is stale of
/// the stages that it needs. Returns an exit code. Throws: Error (bad_config, missing_input) for the job.
int draw_preview(const PreviewCommand& command, Progress& progress);

/// Where that picture stands.
std::filesystem::path preview_file(const PreviewCommand& command, const Job& job);

/// Draws it from files that are fresh. Returns an exit code.
int draw_picture(const PreviewCommand& command, const std::filesystem::path& picture);

struct RelightCommand {
  std::string job_file;
  std::string variant;  ///< Glob; empty: all.
  bool force = false;
  bool explain = false;
  CommonOptions common;
};

/// Makes those frames under other lights in <output>/relit/ that are not as the job makes them now, from the layers of
/// traced ones that are there, and says why; nothing else is run.
/// Goes on past a variant that fails. Returns the exit code of the first failure, else 0.
/// Throws: Error (bad_config, missing_input) for the job.
int relight_jobs(const RelightCommand& command, Progress& progress);

struct ReportCommand {
  std::string job_file;
  std::string variant;  ///< Glob; empty: all.
  CommonOptions common;
};

/// Writes <output>/report.html, one page that needs nothing from elsewhere, after running what is stale. Returns an
/// exit code. Throws: Error (bad_config, missing_input) for the job, (cannot_create, io_error, interrupted).
int write_report_page(const ReportCommand& command, Progress& progress);

struct BenchCommand {
  std::string job_file;
  CommonOptions common;  ///< Without `threads` the measured stages run on one.
};

/// Measures every variant of the job's `bench.sweep` against its reference and writes tables and pictures. A variant
/// that fails is reported and the others go on. Returns the exit code of the first that failed, else 0.
/// Throws: Error (bad_config) without a sweep, (unavailable) without gnuplot, (interrupted), and as bench_reference.
int bench_job(const BenchCommand& command, Progress& progress);

struct InfoCommand {
  std::string file;
};

/// Prints what is in a file. Returns an exit code. Throws: Error (missing_input, bad_data).
int show_info(const InfoCommand& command);

struct DiffCommand {
  std::string a;
  std::string b;
  /// Each a number from 0 up, or such a number for datasets or layers of a name: GLOB=NUMBER; the last that fits
  /// counts.
  std::vector<std::string> tolerance;  ///< What none fits: no difference, or any beside a `max`.
  std::vector<std::string> max;
};

/// Prints how two files of one kind differ. Returns 1 if by more than is allowed, else 0.
/// Throws: Error (usage) for a malformed limit, (missing_input, bad_data).
int compare_files(const DiffCommand& command);

}  // namespace patchlight
