#pragma once
#include <filesystem>
#include <string>

#include "pipeline/stage/stage.h"

namespace patchlight {

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

}  // namespace patchlight
