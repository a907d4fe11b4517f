#pragma once
#include <string>

namespace patchlight {

constexpr std::size_t kLongestLightGroup = 1024;  ///< Bytes.

/// A light group's name as files hold it: `/` and the zero byte become `_`, and so does a name that is a single dot,
/// which HDF5 takes for the group around it.
std::string light_group_name(std::string name);

}  // namespace patchlight
