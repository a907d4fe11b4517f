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

/// The file's materials with the job's overrides applied, and behind them `default` (diffuse, 0.8 grey as Blender's)
/// for what has none.
///
/// Diffuse reflectance is baseColor x (1 - metallic), specular baseColor x metallic, emission pi x emissive factor x
/// strength. Textures are read only where `used` says that a surface has the material: they go into `textures`, alpha
/// of base colours into `masks`. Throws: Error (bad_data) for values out of range; (missing_input) without a texture's
/// file.
std::vector<SurfaceMaterial> read_materials(GltfModel& model, const std::vector<char>& used, const Job& job,
                                            std::vector<Texture>& textures, std::vector<Texture>& masks,
                                            Progress& progress);

/// A material as the job's overrides of nodes have it, for one node; nothing if none of these matches its name.
/// Throws: Error (bad_data, bad_config) for values out of range.
std::optional<SurfaceMaterial> node_material(const GltfModel& model, const Job& job, const std::string& node,
                                             const SurfaceMaterial& material, Progress& progress);

}  // namespace patchlight
