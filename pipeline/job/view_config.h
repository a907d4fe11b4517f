#pragma once
#include <filesystem>
#include <string>

namespace patchlight {

/// The OpenColorIO config of a job that names `chosen`: that one, else that of $OCIO, else none: the one that
/// Patchlight ships. Throws: Error (missing_input).
std::filesystem::path view_config_file(const std::filesystem::path& chosen);

/// Key of the OpenColorIO config that frames are viewed through, view_config_file(). It covers the content of the
/// config and of the LUT files that its FileTransforms name, found as OpenColorIO finds them, wherever they stand, and
/// the environment variables that the config uses. Files that a LUT file names are not covered. OpenColorIO's own
/// Config::getCacheID() will not do: it knows LUT files by their inode. Throws: Error (missing_input, io_error).
std::string view_config_key(const std::filesystem::path& chosen);

}  // namespace patchlight
