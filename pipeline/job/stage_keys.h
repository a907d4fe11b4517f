#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/camera.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A file as SourceFile::path has it; empty for none.
std::string path_beside_scene(const std::filesystem::path& file, const Job& job);

/// Key of what an import reads: the source files' content and the settings that can change patches.h5.
std::string import_inputs_key(const std::vector<SourceFile>& sources, const Job& job);

/// Key of transport.h5 for a patch file's geometry_key and the settings that form factors depend on.
std::string transport_key(const std::string& geometry_key, const SolveConfig& solve);

/// Key of energy.h5 for a patch file's key and the settings of solving.
std::string energy_key(const std::string& patches_key, const SolveConfig& solve);

/// Key of a camera: its name, lens and place.
std::string camera_key(const Camera& camera);

/// Key of one frame: solution, camera, lights, the settings of tracing and the `view_config_key`.
/// `camera`: as it stands at the frame.
std::string frame_key(const PatchSet& scene, const std::string& energy_key, const Job& job, const Camera& camera,
                      int frame, const std::string& view_config);

/// Key of a frame that was relit, which tells it from that of a `frame_key` that was traced. The lights under which the
/// frame that it was made of was traced have no part in it: the layers of light groups do not depend on them.
std::string relit_key(const std::string& frame_key);

}  // namespace patchlight
