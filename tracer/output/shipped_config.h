#pragma once

namespace patchlight {

/// Text of configs/config.ocio at build time.
extern const char* const kShippedOcioConfig;

}  // namespace patchlight
