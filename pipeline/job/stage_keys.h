#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/camera.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A file's path in the form of SourceFile::path; empty without a file.
std::string path_beside_scene(const std::filesystem::path& file, const Job& job);

/// Key of an import: the source files' contents and the settings that affect patches.h5.
std::string import_inputs_key(const std::vector<SourceFile>& sources, const Job& job);

/// Key of transport.h5 for a patch file's geometry_key and the settings that affect form factors.
std::string transport_key(const std::string& geometry_key, const SolveConfig& solve);

/// Key of energy.h5 for a patch file's key and the `solve` settings.
std::string energy_key(const std::string& patches_key, const SolveConfig& solve);

/// Key of a camera: its name, lens and transform.
std::string camera_key(const Camera& camera);

/// Key of one frame: solution, camera, lights, `trace` settings and `view_config_key`. `camera`: at this frame.
std::string frame_key(const PatchSet& scene, const std::string& energy_key, const Job& job, const Camera& camera,
                      int frame, const std::string& view_config);

/// Key of a relit frame; differs from its `frame_key`. Independent of the lights with which the original frame was
/// traced, since its layers of light groups do not depend on them.
std::string relit_key(const std::string& frame_key);

}  // namespace patchlight
