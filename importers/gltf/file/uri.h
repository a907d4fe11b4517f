#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

using Bytes = std::vector<unsigned char>;

/// Whether a glTF URI is a data URI.
bool is_data_uri(std::string_view uri);

/// The bytes of a `data:` URI, base64 or percent-encoded.
/// `where` is the location in the scene, for errors. Throws: Error (bad_data) for malformed base64.
Bytes decode_data_uri(std::string_view uri, const std::string& where);

/// The path of a relative URI, percent-decoded and normalised, relative to the scene's folder.
/// Throws: Error (bad_data) for a scheme, an absolute path, a path that leaves the folder, or one without a file name.
std::filesystem::path confined_path(std::string_view uri, const std::string& where);

}  // namespace patchlight
