#pragma once

namespace patchlight {

/// configs/config.ocio, as it was when the program was built.
extern const char* const kShippedOcioConfig;

}  // namespace patchlight
