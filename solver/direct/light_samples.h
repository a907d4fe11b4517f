#pragma once
#include <span>
#include <vector>

#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/lights/further_lights.h"
#include "solver/form_factors/visible_density.h"

namespace patchlight {

/// Samples the form factors from receivers to many emitters, by a LightTree: their number costs as its logarithm.
class LightSampler {
 public:
  /// `emitters`: see further_emitters().
  LightSampler(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Emitter>& emitters,
               std::uint64_t seed);

  /// Form factors of `receivers`, patches or points of no size, by `rays` rays in each of two sample sets. `densities`:
  /// of points over the receivers. The result does not depend on the number of threads. Adds the number of rays to
  /// `cast`. Throws: Error (interrupted).
  LightRows sample(std::span<const Patch> receivers, const VisibleDensities& densities, int rays,
                   std::int64_t& cast) const;

 private:
  struct Entries;

  void cast_rays(const Patch& receiver, const VisibleDensity* density, const std::vector<LightTree::Choice>& choices,
                 std::uint64_t random, Entries& entries) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const FurtherLights lights_;
  const std::uint64_t seed_;
};

/// Rays of a sample set to many emitters, where rows have `rays` rays.
int light_rays(int rays);

/// Identifies a list of emitters by their patches; 0: an empty list.
std::int64_t emitters_id(const std::vector<Emitter>& emitters);

}  // namespace patchlight
