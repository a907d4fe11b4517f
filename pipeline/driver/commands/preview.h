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

/// Updates the stages that the picture needs, then draws a job's patches, radiosity or hemicubes into
/// <output>/preview/. Returns an exit code. Throws: Error (bad_config, missing_input) for the job.
int draw_preview(const PreviewCommand& command, Progress& progress);

/// Path of that picture.
std::filesystem::path preview_file(const PreviewCommand& command, const Job& job);

/// Draws the picture from fresh files. Returns an exit code.
int draw_picture(const PreviewCommand& command, const std::filesystem::path& picture);

}  // namespace patchlight
