#pragma once
#include <array>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Normals that run smoothly over the facets of curved meshes: at a smooth vertex the mean of its facets' normals,
/// weighted by their angles there (Thuermer and Wuethrich 1998), and bilinear between vertices.
class SmoothNormals {
 public:
  explicit SmoothNormals(const PatchSet& scene);

  /// At (u,v) of primitive `i`, whose own normal there is `flat`. Unit length.
  Vec3f operator()(std::int32_t i, float u, float v, const Vec3f& flat) const;

 private:
  std::vector<std::int32_t> at_;               ///< [primitives], into `corners_`; -1: plane surroundings.
  std::vector<std::array<Vec3f, 4>> corners_;  ///< Unit vectors.
};

}  // namespace patchlight
