#pragma once
#include <string>

#include "importers/gltf/read/scene_textures.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Throws: Error (bad_data): `what` is wrong with a material; `range`: of the values that are allowed.
[[noreturn]] void refuse_material(const GltfModel& model, const std::string& material, const std::string& what,
                                  const std::string& range);

/// The dielectric layer over a material's diffuse part, by `KHR_materials_ior` and `KHR_materials_specular`, whose
/// textures count by their means. `used`: they are read. Throws: Error (bad_data) for values out of range, and as
/// SceneTextures::mean does.
Coat read_coat(const tinygltf::Material& source, SceneTextures& textures, bool used, const std::string& name);

/// The clear coat over a material, by `KHR_materials_clearcoat`. Its textures count by their means. `used`: they are
/// read. Throws: Error (bad_data) for values out of range, and as SceneTextures::mean does.
ClearCoat read_clear_coat(const tinygltf::Material& source, SceneTextures& textures, bool used,
                          const std::string& name);

/// What a material lets pass, by `KHR_materials_transmission` and `_volume`, without its tint. `used`: the mean of the
/// texture counts. Throws: Error (bad_data) for values out of range, and as SceneTextures::mean does.
Transmission read_transmission(const tinygltf::Material& source, SceneTextures& textures, bool used,
                               const std::string& name);

/// The part of the light below the coat that leaves the other side diffusely, by `KHR_materials_diffuse_transmission`.
/// Its textures count by their means. Parameters and errors: as of read_transmission().
struct DiffuseTransmission {
  float part = 0.0f;
  Color color{1.0f};
};
DiffuseTransmission read_diffuse_transmission(const tinygltf::Material& source, SceneTextures& textures, bool used,
                                              const std::string& name);

}  // namespace patchlight
