#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <optional>
#include <string>
#include <vector>

#include "importers/gltf/model/gltf_model.h"
#include "importers/mesh/surface.h"
#include "pipeline/job/job.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// The file's materials with the job's overrides applied, followed by `default` (diffuse grey 0.8, as in Blender) if
/// surfaces without a material exist.
///
/// Diffuse reflectance is baseColor x (1 - metallic), specular baseColor x metallic, emission pi x emissive factor x
/// strength. Textures are read only for materials in use (`used`, by material, the default one last) and appended to
/// `textures`, the alpha of base colours to `masks`. Throws: Error (bad_data) for values out of range; (missing_input)
/// if a texture's file does not exist.
std::vector<SurfaceMaterial> read_materials(GltfModel& model, const std::vector<char>& used, const Job& job,
                                            std::vector<Texture>& textures, std::vector<Texture>& masks,
                                            Progress& progress);

/// A material with the job's overrides of this node applied; nothing if no override matches the node's name.
/// Throws: Error (bad_data, bad_config) for values out of range.
std::optional<SurfaceMaterial> node_material(const GltfModel& model, const Job& job, const std::string& node,
                                             const SurfaceMaterial& material, Progress& progress);

}  // namespace patchlight
