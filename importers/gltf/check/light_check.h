#pragma once
#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {

/// Checks and reads the lights of KHR_lights_punctual. Warns of unknown types.
/// Throws: Error (bad_data) naming the light.
std::vector<GltfLight> checked_lights(GltfLists& gltf);

/// Indices into `lights` by node; without lights of unknown types. Throws: Error (bad_data) for an index out of range.
std::map<int, int> checked_node_lights(const GltfLists& gltf, const std::vector<GltfLight>& lights);

/// The profiles of EXT_lights_ies. Throws: Error (bad_data) naming the profile.
std::vector<GltfData> checked_light_profiles(const GltfLists& gltf);

/// The profiles that nodes use. Throws: Error (bad_data) naming the node.
std::map<int, GltfProfileLight> checked_profile_lights(const GltfLists& gltf, std::size_t profiles);

/// See CheckedGltf::node_light_extras; `checked` has its lights and parents. Throws: Error (bad_data) naming the node.
std::map<int, GltfLightExtras> checked_light_extras(const GltfLists& gltf, const CheckedGltf& checked);

}  // namespace patchlight
