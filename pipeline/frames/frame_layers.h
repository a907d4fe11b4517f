#pragma once
#include <string>
#include <vector>

#include "pipeline/image/image_file.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The layers of a frame that `config` asks for, in its order, without values.
/// Throws: Error (bad_config) for a light group whose name no channel can have.
std::vector<ImageLayer> frame_layers(const TraceConfig& config, const PatchSet& scene);

/// Those of them that a relit frame has too.
std::vector<ImageLayer> relit_layers(const TraceConfig& config, const PatchSet& scene);

/// Whether a layer holds light by the way that it came, of all groups together, so that no sum of single ones makes it.
bool holds_light_by_its_way(const std::string& layer);

/// Whether two layers have the same name, channels and kind of values.
bool are_alike(const ImageLayer& a, const ImageLayer& b);

/// The name of the first of `wanted` that an image lacks; empty: it has all.
std::string lacking_layer(const Image& image, const std::vector<ImageLayer>& wanted);

}  // namespace patchlight
