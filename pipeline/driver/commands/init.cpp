#include "pipeline/driver/commands/init.h"

#include <cstdlib>
#include <filesystem>

#include "pipeline/driver/cache/freshness.h"
#include "pipeline/driver/commands/starter_job.h"
#include "pipeline/driver/stages/stage_program.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/job/reader/scene_file.h"
#include "pipeline/model/error.h"
#include "pipeline/system/standard_streams.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

/// A folder that is removed with all that is in it.
class TemporaryFolder {
 public:
  /// Throws: Error (cannot_create).
  TemporaryFolder() {
    std::error_code fault;
    std::string name = (fs::temp_directory_path(fault) / "patchlight-init.XXXXXX").string();
    if (fault || !mkdtemp(name.data()))
      throw Error(ExitCode::cannot_create, "cannot make a temporary folder", name, "set $TMPDIR to a writable folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

int print_starter_job(const InitCommand& command, Progress&) {
  Progress::catch_signals();
  const fs::path scene_file = command.scene;
  if (!is_scene_file(scene_file))
    throw Error(ExitCode::usage, "not a scene", command.scene, "name a .glb, .gltf or .blend file");
  if (!command.common.sets.empty())
    throw Error(ExitCode::usage, "`patchlight init` has no overrides", "--set " + command.common.sets.front(),
                "leave it out, and edit the job that is printed");
  const Job job = read_job(scene_file);
  PatchSet scene;
  if (!patches_freshness(job, scene).fresh()) {
    const TemporaryFolder folder;
    CommonOptions options = command.common;
    options.output = folder.path().string();
    options.quiet = true;
    if (const int code = run_stage_program("import", stage_arguments(command.scene, options)).exit_code) return code;
    scene = read_patches(folder.path() / job.patch_file().filename());
  }
  const std::string output = !command.common.output.empty()
                                 ? command.common.output
                                 : (scene_file.parent_path() / job.output.filename()).string();
  print(starter_job(command.scene, output, scene));
  return 0;
}

}  // namespace patchlight
