#pragma once
#include <filesystem>

namespace patchlight {

/// Whether a file's name is that of a scene, not of a job: .glb, .gltf or .blend, in letters of either case.
bool is_scene_file(const std::filesystem::path& file);

/// Whether a file's name is that of a Blender file.
bool is_blender_file(const std::filesystem::path& file);

}  // namespace patchlight
