#pragma once
#include <string>

namespace patchlight {

constexpr std::size_t kLongestLightGroup = 1024;  ///< Bytes.

/// The name of a light group in files: `/` and the zero byte are replaced by `_`, and so is the name `.`, which in HDF5
/// means the enclosing group.
std::string light_group_name(std::string name);

}  // namespace patchlight
