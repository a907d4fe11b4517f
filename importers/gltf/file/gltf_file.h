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

/// A scene file as read from disk: its JSON text, its binary chunk, and the files it refers to, each read once.
struct GltfFile {
  std::filesystem::path path;
  std::string name;  ///< File name, for messages.
  std::shared_ptr<const Bytes> content;
  std::string_view json;                        ///< Into `content`.
  std::span<const unsigned char> binary_chunk;  ///< Into `content`.
  bool has_binary_chunk = false;
  std::map<std::filesystem::path, std::shared_ptr<const Bytes>> files;  ///< By path relative to the scene.
  std::vector<SourceFile> sources;                                      ///< All files read; the scene file first.
};

/// Reads a .gltf or .glb file; the first bytes decide which it is.
/// Throws: Error (missing_input) if it does not exist; (bad_data) for chunks that exceed it; (over_limit, io_error).
GltfFile read_gltf_file(const std::filesystem::path& path);

/// The bytes of a buffer's or image's URI: a decoded data URI, or a file in the scene's folder.
/// `where` is the location in the scene, for errors.
/// Throws: Error (missing_input) if the file does not exist; (bad_data) for a forbidden URI; (over_limit, io_error).
std::shared_ptr<const Bytes> read_uri(GltfFile& file, std::string_view uri, const std::string& where);

/// The bytes of a file that the job names, which is recorded as a source by the name `source`.
/// Throws: Error (missing_input, bad_data, over_limit, io_error).
std::shared_ptr<const Bytes> read_input(GltfFile& file, const std::filesystem::path& path, const std::string& source,
                                        const std::string& where);

}  // namespace patchlight
