#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <string>
#include <vector>

#include "importers/gltf/model/gltf_model.h"
#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// A light in world space, and the name of its light group.
struct PlacedLight {
  Light light;
  std::string group;
};

/// The light of a node, in W/sr or W/m2 whatever unit the file uses. Nothing if the node has none, its strength is 0,
/// the job excludes it, or its transform gives no direction. Its name is the node's, or the parent's if Blender's
/// exporter added the node to rotate the light. Scale is ignored. Light group, in order of precedence: job,
/// `light_group` of the node, `light_group` of the light, name of the light. Radius, or angle of a sun: job, node,
/// light. Throws: Error (bad_data) for a non-finite or far too distant position.
std::optional<PlacedLight> placed_light(const GltfModel& model, const Job& job, const std::vector<std::string>& names,
                                        int node, const Matrix4& to_world, Progress& progress);

/// Throws: Error (bad_config) if the job sets a size for a light group without lights that can have it.
void check_light_sizes(const Job& job, const std::vector<Light>& lights, const std::vector<std::string>& groups);

}  // namespace patchlight
