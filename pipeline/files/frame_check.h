#pragma once
#include <string>

#include "pipeline/files/frame_list.h"

namespace patchlight {

/// Whether a frame's EXR and PNG are whole and carry the key.
bool is_fresh(const Frame& frame, const std::string& frame_key);

}  // namespace patchlight
