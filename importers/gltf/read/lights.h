#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <string>
#include <vector>

#include "importers/gltf/model/gltf_model.h"
#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// A light of the scene, and the name of its group.
struct PlacedLight {
  Light light;
  std::string group;
};

/// The light on a node, in W/sr or W/m2 whatever the file's unit; nothing if there is none, if it has no strength, the
/// job excludes it, or its transform leaves no direction. It goes by the name of the node, or, of one that Blender's
/// exporter puts below a lamp to turn it, by the lamp's. Scale has no say.
/// The group is named by the job, else by the node's `light_group`, else by the light's, else it is the light's name.
/// Throws: Error (bad_data) for a place that is not finite.
std::optional<PlacedLight> placed_light(const GltfModel& model, const Job& job, const std::vector<std::string>& names,
                                        int node, const Matrix4& to_world, Progress& progress);

}  // namespace patchlight
