#pragma once
#include <string>

namespace patchlight {

/// The version and, if it is built from a Git checkout, the commit; for instance, `patchlight 0.1.0 (1a2b3c4)`. No key
/// of an output may depend on it.
std::string patchlight_version();

}  // namespace patchlight
