#include "pipeline/driver/commands.h"
#include "pipeline/driver/stage_program.h"

namespace patchlight {

int draw_preview(const PreviewCommand& command, Progress& progress) {
  const bool shows_light = command.kind == "radiosity" || command.kind == "irradiance";
  const RunCommand before{command.job_file, false, command.common, shows_light ? "solve" : "import"};
  if (const int code = run_job(before, progress)) return code;

  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  const std::string of = !command.camera.empty() ? "." + command.camera : "";
  const std::string at = !command.patch.empty() ? ".patch" + command.patch : "";
  std::string name = command.kind + of + at + ".png";
  for (char& c : name)
    if (c == '/') c = '_';
  std::vector<std::string> arguments{"--picture=" + (job.output / "preview" / name).string(), "--kind=" + command.kind};
  if (!command.camera.empty()) arguments.push_back("--camera=" + command.camera);
  if (!command.patch.empty()) arguments.push_back("--patch=" + command.patch);
  const std::vector<std::string> common = stage_arguments(command.job_file, command.common);
  arguments.insert(arguments.end(), common.begin(), common.end());
  return run_stage_program("preview", arguments).exit_code;
}

}  // namespace patchlight
