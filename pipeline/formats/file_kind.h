#pragma once
#include <filesystem>

namespace patchlight {

enum class FileKind { scene, patches, transport, transport_shard, energy, frame };

/// The kind of a file, from its first bytes and, for HDF5, its `format` attribute. Files that are neither HDF5 nor EXR
/// count as glTF scenes. Throws: Error (missing_input); (bad_data) for an HDF5 file of another program.
FileKind kind_of(const std::filesystem::path& file);

}  // namespace patchlight
