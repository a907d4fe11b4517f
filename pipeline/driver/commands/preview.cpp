#include "pipeline/driver/commands/preview.h"

#include "pipeline/driver/commands/run.h"
#include "pipeline/driver/stages/run_command.h"
#include "pipeline/driver/stages/stage_program.h"
#include "pipeline/job/reader/job_reader.h"

namespace patchlight {

std::filesystem::path preview_file(const PreviewCommand& command, const Job& job) {
  const std::string of = !command.camera.empty() ? "." + command.camera : "";
  const std::string at = !command.patch.empty() ? ".patch" + command.patch : "";
  std::string name = command.kind + of + at + ".png";
  for (char& c : name)
    if (c == '/') c = '_';
  return job.output / "preview" / name;
}

int draw_picture(const PreviewCommand& command, const std::filesystem::path& picture) {
  std::vector<std::string> arguments{"--picture=" + picture.string(), "--kind=" + command.kind};
  if (!command.camera.empty()) arguments.push_back("--camera=" + command.camera);
  if (!command.patch.empty()) arguments.push_back("--patch=" + command.patch);
  const std::vector<std::string> common = stage_arguments(command.job_file, command.common);
  arguments.insert(arguments.end(), common.begin(), common.end());
  return run_stage_program("preview", arguments).exit_code;
}

int draw_preview(const PreviewCommand& command, Progress& progress) {
  const bool shows_light = command.kind == "radiosity" || command.kind == "irradiance";
  const RunCommand before{command.job_file, false, command.common, shows_light ? "solve" : "import"};
  if (const int code = run_job(before, progress)) return code;
  return draw_picture(command,
                      preview_file(command, read_job(command.job_file, command.common.sets, command.common.output)));
}

}  // namespace patchlight
