#include "pipeline/driver/commands.h"
#include "pipeline/driver/stage_program.h"

namespace patchlight {

int draw_preview(const PreviewCommand& command) {
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  const std::string of = !command.camera.empty() ? "." + command.camera : "";
  const std::string at = !command.patch.empty() ? ".patch" + command.patch : "";
  std::string name = command.kind + of + at + ".png";
  for (char& c : name)
    if (c == '/') c = '_';
  std::vector<std::string> arguments = stage_arguments(command.job_file, command.common);
  arguments.insert(arguments.end(), {"--preview", (job.output / "preview" / name).string(), "--kind", command.kind});
  if (!command.camera.empty()) arguments.insert(arguments.end(), {"--camera", command.camera});
  if (!command.patch.empty()) arguments.insert(arguments.end(), {"--patch", command.patch});
  return run_stage_program("solve", arguments).exit_code;
}

}  // namespace patchlight
