#include "pipeline/frames/frame_check.h"

#include "pipeline/frames/frame_layers.h"
#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

bool is_fresh(const Frame& frame, const std::string& frame_key, const std::vector<ImageLayer>& layers) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(frame.exr, fault) || !std::filesystem::is_regular_file(frame.png, fault))
    return false;
  try {
    Image header = read_exr_header(frame.exr);
    if (header.metadata["patchlight:key"] != frame_key || header.metadata["patchlight:png"] != hash_file(frame.png) ||
        !missing_layer(header, layers).empty())
      return false;
    read_exr(frame.exr);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace patchlight
