#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Shading normals of curved meshes and of normal textures.
class SmoothNormals {
 public:
  explicit SmoothNormals(const PatchSet& scene) : scene_(scene) {}

  /// The shading normal at (u,v) of primitive `i`, whose geometric normal is `flat`. Unit length.
  Vec3f operator()(std::int32_t i, float u, float v, const Vec3f& flat) const {
    return is_flat(i) ? flat : interpolated(i, u, v, flat);
  }

  /// The shading normal, turned by a normal texture if primitive `i` has one. glTF's tangent space, from texture
  /// coordinates; backs are shaded by the reversed normal of their front. `smooth`: by the operator above. Unit length.
  Vec3f mapped(std::int32_t i, float u, float v, const Vec3f& smooth) const {
    return scene_.primitives[i].normal_texture < 0 ? smooth : turned_by_texture(i, u, v, smooth);
  }

  /// A point of primitive `i` at (u,v), moved to the smooth surface that its normals describe where that lies above the
  /// facet: shadow rays from there do not meet the facet's own neighbours (Hanika, "Hacking the Shadow Terminator",
  /// Ray Tracing Gems II, 2021).
  Vec3d on_smooth_surface(std::int32_t i, float u, float v, const Vec3d& point) const {
    return is_flat(i) ? point : lifted(i, u, v, point);
  }

  bool is_flat(std::int32_t i) const { return scene_.normals.empty() || scene_.normals[i] == kFlatNormals; }

 private:
  Vec3f turned_by_texture(std::int32_t i, float u, float v, const Vec3f& smooth) const;
  Vec3f interpolated(std::int32_t i, float u, float v, const Vec3f& flat) const;
  Vec3d lifted(std::int32_t i, float u, float v, const Vec3d& point) const;

  const PatchSet& scene_;
};

/// A shading normal, turned towards the surface's own normal `flat` as far as it must be for the mirror image of the
/// direction to the viewer to lie above the surface. Blender's Cycles shades with such normals. Unit vectors.
Vec3f valid_for_viewer(const Vec3f& normal, const Vec3f& flat, const Vec3f& to_viewer);

}  // namespace patchlight
