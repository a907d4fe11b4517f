#pragma once
#include <span>
#include <vector>

#include "solver/direct/direct_factors.h"
#include "solver/direct/photons.h"

namespace patchlight {

/// Light of explicitly sampled emitters that metals reflect onto patches: from virtual images in the largest plane
/// mirrors, and by photons over other metals and over more than one mirror.
class MirroredLight {
 public:
  /// `direct`: of the scene's patches; must outlive this object.
  MirroredLight(const PatchSet& scene, const RayScene& ray_scene, const DirectFactors& direct, std::uint64_t seed);

  /// Extended form factors of all patches to `emitter`, one of `emitters`, for rows of `rays` rays. Shape: [2 patches]:
  /// [patch][sample set]; empty: no metals. `visible_fractions`: as in TransportRows. Adds the number of rays to
  /// `cast`. Throws: Error (interrupted).
  std::vector<Color> sample(const Emitter& emitter, std::size_t emitters, int rays,
                            std::span<const float> visible_fractions, std::int64_t& cast) const;

 private:
  const std::size_t patches_;
  const DirectFactors& direct_;
  const std::vector<PlaneMirror> mirrors_;
  const Photons photons_;
};

}  // namespace patchlight
