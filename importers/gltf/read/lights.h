#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <string>
#include <vector>

#include "importers/gltf/model/photometric_files.h"
#include "importers/gltf/read/gltf_reader.h"
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
/// `light_group` of the node, `light_group` of the light, name of the light. Radius, angle of a sun, and photometric
/// file: job, node, light. Throws: Error (bad_data) for a non-finite or far too distant position, or a photometric file
/// of a sun; likewise for faults of photometric files.
std::optional<PlacedLight> placed_light(const GltfModel& model, const Job& job, const std::vector<std::string>& names,
                                        int node, const Matrix4& to_world, PhotometricFiles& files, Progress& progress);

/// Throws: Error (bad_config) if the job sets a size or a photometric file for a light group without lights that can
/// have it, or a photometric file for a group with other emitters; Error (bad_data) if a node of an emissive mesh has a
/// photometric file.
void check_light_settings(const GltfModel& model, const Job& job, const GltfScene& scene);

}  // namespace patchlight
