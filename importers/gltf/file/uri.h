#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

using Bytes = std::vector<unsigned char>;

/// Whether a glTF URI holds its data itself.
bool is_data_uri(std::string_view uri);

/// The bytes of a `data:` URI, base64 or percent-encoded.
/// `where` names the place in the scene for errors. Throws: Error (bad_data) for malformed base64.
Bytes decode_data_uri(std::string_view uri, const std::string& where);

/// The file that a relative URI names, percent-decoded and normalised, relative to the scene's folder.
/// Throws: Error (bad_data) for a scheme, an absolute path, a path out of the folder, or no file name at all.
std::filesystem::path confined_path(std::string_view uri, const std::string& where);

}  // namespace patchlight
