#pragma once
#include <algorithm>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/surface/lattices.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Direct irradiance of patches by lights and the environment, which have no patches to shoot from, W/m2, with `rays`
/// rays a patch. Results have shape [n] and no negative values, and do not depend on the number of threads.
class ExternalIrradiance {
 public:
  ExternalIrradiance(const PatchSet& scene, int rays, std::uint64_t seed)
      : scene_(scene), ray_scene_(scene), lookup_(scene), lattices_(scene, lookup_), rays_(rays), seed_(seed) {}

  /// `emitter`: one without patches. Adds the number of rays to `cast`. Throws: Error (interrupted).
  std::vector<Vec3d> of_light(const Emitter& emitter, std::int64_t& cast) const;

  /// Of the scene's environment, filtered. Adds the number of rays to `cast`. Throws: Error (interrupted).
  std::vector<Vec3d> of_environment(std::int64_t& cast, Progress& progress) const;

 private:
  const PatchSet& scene_;
  const RayScene ray_scene_;
  const PatchLookup lookup_;
  const Lattices lattices_;
  const int rays_;
  const std::uint64_t seed_;
};

/// Components below 0 become 0.
inline Vec3d positive(const Vec3d& c) {
  return {std::max(c.x, 0.0), std::max(c.y, 0.0), std::max(c.z, 0.0)};
}

}  // namespace patchlight
