#include "pipeline/driver/commands/from_blend.h"

#include <filesystem>
#include <memory>

#include "pipeline/job/blender/blender_export.h"
#include "pipeline/job/reader/scene_file.h"
#include "pipeline/model/error.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace fs = std::filesystem;

int export_from_blend(const FromBlendCommand& command, Progress& progress) {
  Progress::catch_signals();
  const fs::path blend = fs::absolute(command.blend), folder = blend.parent_path();
  if (!is_blender_file(blend)) throw Error(ExitCode::usage, "not a Blender file", blend, "name a .blend file");
  const fs::path made = folder / (kTemporaryPrefix + blend.stem().string());
  const auto discard = [](const fs::path* path) {
    std::error_code ignored;
    fs::remove_all(*path, ignored);
  };
  const std::unique_ptr<const fs::path, decltype(discard)> owner(&made, discard);
  const BlenderExport blender = export_blender_file(blend, made);
  Progress::check_interrupted();
  for (const std::string& warning : blender.warnings) progress.warning(warning);
  std::error_code fault;
  for (const std::string& input : blender.inputs)
    for (const std::string& name : blender.files)
      if (fs::equivalent(folder / input, folder / name, fault))
        throw Error(ExitCode::cannot_create, "the export would replace a file of the scene", folder / name,
                    "move the Blender file to a folder of its own, or rename the other");
  for (const std::string& name : blender.files) {
    const fs::path file = folder / name;
    if (file.extension() == ".yaml" && !command.force && fs::exists(file, fault)) {
      progress.note(file.string() + " stays as it is; --force replaces it");
      continue;
    }
    fs::rename(made / name, file, fault);
    if (fault) throw Error(ExitCode::cannot_create, "cannot write it: " + fault.message(), file, "is it a folder?");
    progress.note("wrote " + file.string());
  }
  return 0;
}

}  // namespace patchlight
