#pragma once
#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

struct EmbreeRay {
  Vec3f origin, direction;
};

/// Embree as its users run it, for comparison.
class PlainEmbree {
 public:
  /// Triangles with Embree's default settings, or what differs from that.
  enum class Variant { triangles, quads, robust, compact, high_quality };

  /// The scene's primitives, regions as their pieces and spheres as 64 x 32 quads, in the coordinates of `rays`.
  PlainEmbree(const PatchSet& scene, const RayScene& rays, Variant variant);
  ~PlainEmbree();
  PlainEmbree(const PlainEmbree&) = delete;
  PlainEmbree& operator=(const PlainEmbree&) = delete;

  /// Traces the rays in packets of `width`, 8 or 16; their number must be a multiple of 16.
  std::int64_t count_hits(const std::vector<EmbreeRay>& rays, int width, bool coherent) const;

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace patchlight
