#pragma once
#include <filesystem>

namespace patchlight {

enum class FileKind { scene, patches, transport, transport_shard, energy, frame };

/// What a file is, by its first bytes and, for HDF5, its `format` attribute. What is neither HDF5 nor EXR counts as a
/// glTF scene. Throws: Error (missing_input), (bad_data) for an HDF5 file that is not ours.
FileKind kind_of(const std::filesystem::path& file);

}  // namespace patchlight
