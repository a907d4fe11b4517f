#pragma once
#include <string>
#include <vector>

#include "pipeline/image/image_file.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The layers of a frame that `config` asks for, in its order, without values.
/// Throws: Error (bad_config) for a light group whose name is too long for a channel.
std::vector<ImageLayer> frame_layers(const TraceConfig& config, const PatchSet& scene);

/// The layers that a relit frame has too: all except layers by light path.
std::vector<ImageLayer> relit_layers(const TraceConfig& config, const PatchSet& scene);

/// Whether a layer holds light of one kind of path (direct, indirect, ...) from all groups. It cannot be computed from
/// the layers of light groups.
bool is_light_path_layer(const std::string& layer);

/// Whether two layers have the same name, channels and value type.
bool have_same_format(const ImageLayer& a, const ImageLayer& b);

/// Name of the first of the `wanted` layers that is missing in an image; empty: none.
std::string missing_layer(const Image& image, const std::vector<ImageLayer>& wanted);

}  // namespace patchlight
