#pragma once
#include <cstdint>
#include <optional>

#include "pipeline/optics/lights/sky.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/optics/transport/face_lookup.h"

namespace patchlight {

/// Numbers of the elements that rays end on: first the patches; then the display mesh's faces, which replace subdivided
/// patches; last the cells of the environment.
class Elements {
 public:
  explicit Elements(const PatchSet& scene)
      : scene_(scene), lookup_(scene), first_sky_(std::int32_t(scene.patches.size())) {}
  Elements(const PatchSet& scene, const DisplayMesh& mesh)
      : scene_(scene),
        lookup_(scene),
        faces_(std::in_place, scene, mesh),
        first_sky_(std::int32_t(scene.patches.size()) + mesh.elements()) {}

  struct Place {
    std::int32_t element;
    bool cut;  ///< Whether it is a face that is a part of its leaf.
  };

  /// The element at (u,v) of primitive `i`.
  Place find(std::int32_t i, float u, float v) const {
    const std::int32_t patch = lookup_.patch(i, u, v);
    if (!faces_) return {patch, false};
    const FaceLookup::Place at = faces_->find(patch, u, v);
    return {at.face < 0 ? patch : std::int32_t(scene_.patches.size()) + at.face, at.cut};
  }
  std::int32_t at(std::int32_t i, float u, float v) const { return find(i, u, v).element; }

  /// The element of a ray in this direction that hits no surface; -1 without an environment.
  std::int32_t sky(const Vec3f& direction) const {
    return scene_.environment ? first_sky_ + sky_cell(*scene_.environment, direction) : -1;
  }

  bool is_sky(std::int32_t element) const { return element >= first_sky_; }

 private:
  const PatchSet& scene_;
  const PatchLookup lookup_;
  const std::optional<FaceLookup> faces_{};
  const std::int32_t first_sky_;
};

}  // namespace patchlight
