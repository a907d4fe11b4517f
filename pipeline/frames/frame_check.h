#pragma once
#include <string>
#include <vector>

#include "pipeline/frames/frame_list.h"
#include "pipeline/image/image_file.h"

namespace patchlight {

/// Whether a frame's EXR and PNG are undamaged, have the key, and contain `layers`.
bool is_fresh(const Frame& frame, const std::string& frame_key, const std::vector<ImageLayer>& layers);

}  // namespace patchlight
