#pragma once
#include <string>

namespace patchlight {

/// Key of the OpenColorIO config that frames are viewed through: that of $OCIO, or the one that Patchlight ships. It
/// covers the content of the config and of the LUT files that its FileTransforms name, found as OpenColorIO finds them,
/// wherever they stand, and the environment variables that the config uses. Files that a LUT file names are not
/// covered. OpenColorIO's own Config::getCacheID() will not do: it knows LUT files by their inode. Throws: Error
/// (missing_input, io_error).
std::string view_config_key();

}  // namespace patchlight
