#pragma once
#include <filesystem>

namespace patchlight {

/// The program of Blender: $BLENDER, else `blender` in $PATH, else where its installers put it. Throws: Error
/// (unavailable) if there is none.
std::filesystem::path blender_program();

/// The folder of the exporter that Blender runs: share/patchlight/blender beside the folder of this program. Throws:
/// Error (internal) if it is missing.
std::filesystem::path blender_exporter();

}  // namespace patchlight
