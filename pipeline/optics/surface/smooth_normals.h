#pragma once
#include <array>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Smooth shading normals of curved meshes: at a smooth vertex the mean of its facets' normals, weighted by their
/// angles at the vertex (Thuermer and Wuethrich 1998); bilinear between vertices.
class SmoothNormals {
 public:
  explicit SmoothNormals(const PatchSet& scene);

  /// The shading normal at (u,v) of primitive `i`, whose geometric normal is `flat`. Unit length.
  Vec3f operator()(std::int32_t i, float u, float v, const Vec3f& flat) const;

 private:
  std::vector<std::int32_t> corner_index_;     ///< [primitives] Index into `corners_`; -1: flat.
  std::vector<std::array<Vec3f, 4>> corners_;  ///< Unit normals at the corners.
};

}  // namespace patchlight
