#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include <set>
#include <string>
#include <vector>

#include "importers/gltf_check.h"
#include "importers/gltf_json.h"

namespace patchlight {

/// The channels of animations that move cameras: those of camera nodes and of nodes above them, each property once.
/// What else is animated goes to `ignored`, as one warning. Checks types, indices, and that each sampler has as many
/// values as times; `parents` by node, -1 for a root.
/// Throws: Error (bad_data) naming the animation.
std::vector<GltfChannel> camera_channels(const Json& root, const std::vector<int>& parents, const std::string& file,
                                         std::set<std::string>& ignored);

}  // namespace patchlight
