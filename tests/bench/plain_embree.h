#pragma once
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

using Triangle = std::array<Vec3f, 3>;

struct EmbreeRay {
  Vec3f origin, direction;
};

/// The primitives of a scene as triangles, spheres as 64 x 32 facets, in the coordinates of `rays`.
std::vector<Triangle> triangles_of(const PatchSet& scene, const RayScene& rays);

/// Embree as its users run it, for comparison.
class PlainEmbree {
 public:
  explicit PlainEmbree(const std::vector<Triangle>& triangles);
  ~PlainEmbree();
  PlainEmbree(const PlainEmbree&) = delete;
  PlainEmbree& operator=(const PlainEmbree&) = delete;

  /// Traces the rays in packets of `width`, 8 or 16; their number must be a multiple of 16.
  std::int64_t count_hits(const std::vector<EmbreeRay>& rays, int width) const;

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace patchlight
