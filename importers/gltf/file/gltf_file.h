#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "importers/gltf/file/uri.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A scene file as read from disk: its JSON text, its binary chunk, and what was read beside it.
/// Files are kept, so that a file that many URIs name is read once.
struct GltfFile {
  std::filesystem::path path;
  std::string name;  ///< Of the file, for messages.
  std::shared_ptr<const Bytes> content;
  std::string_view json;                        ///< Into `content`.
  std::span<const unsigned char> binary_chunk;  ///< Into `content`.
  bool has_binary_chunk = false;
  std::map<std::filesystem::path, std::shared_ptr<const Bytes>> files;  ///< Beside the scene, by relative path.
  std::vector<SourceFile> sources;                                      ///< The scene file first.
};

/// Reads a .gltf or .glb file, told apart by its first bytes.
/// Throws: Error (missing_input) without the file; (bad_data) for chunks that do not fit in it; (over_limit, io_error).
GltfFile read_gltf_file(const std::filesystem::path& path);

/// The bytes behind a buffer's or image's URI: decoded, or read from a file in the scene's folder.
/// `where` names the place in the scene for errors.
/// Throws: Error (missing_input) without the file; (bad_data) for a URI that is not allowed; (over_limit, io_error).
std::shared_ptr<const Bytes> read_uri(GltfFile& file, std::string_view uri, const std::string& where);

}  // namespace patchlight
