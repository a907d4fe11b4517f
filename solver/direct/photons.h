#pragma once
#include <span>

#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/stage/progress.h"
#include "solver/direct/photon_source.h"
#include "solver/direct/photon_targets.h"

namespace patchlight {

/// Irradiance of patches by specular reflection in metals, found by tracing photons from the emitters (Arvo 1986):
/// rays from a patch would hardly ever find a small emitter through a mirror.
///
/// Photons leave an emitter uniformly over its area, aimed at the metals as by projection maps (Jensen 1996, section
/// 3.1), and carry the flux that the cosine law gives their direction. Metals reflect them as they reflect the rays of
/// RayRows. After the first metal a photon deposits its flux on the front of every surface it hits. Targets receive
/// photons in proportion to their power in a pilot pass, but each a minimum, so that none is missed.
class Photons {
 public:
  /// `imaged`: mirrors by which emitters have virtual images. Light that only one of them reflects is left out.
  Photons(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed,
          std::span<const PlaneMirror> imaged = {});

  /// Whether any light needs photons: not without metals, nor with mirrors alone that see no other.
  bool has_paths() const { return has_paths_; }

  /// Irradiance of each patch by specular reflection, over the emitter's exitance or a light's strength, from two
  /// independent sample sets with at least `photons` photons together. The result does not depend on the number of
  /// threads. Shape: [2 patches]: [patch][sample set]. Adds the number of rays to `cast`. Throws: Error (interrupted).
  std::vector<Color> shoot(const Emitter& emitter, std::int64_t photons, std::int64_t& cast) const;

 private:
  struct Batch;
  struct Deposit;

  bool has_paths(std::span<const PlaneMirror> imaged) const;
  float pilot_power(const PhotonSource& source, int target) const;
  std::vector<Batch> batches(const PhotonSource& source, std::int64_t photons) const;
  struct Way;
  struct Flight;
  void intersect(Flight& flight) const;
  bool go_on(const SurfaceHit& hit, std::uint64_t random, int lane, Flight& flight) const;
  void start(const PhotonSource& source, const Batch& batch, std::uint32_t first, Flight& flight) const;
  void trace(const PhotonSource& source, const Batch& batch, std::vector<Deposit>& deposits, std::int64_t& cast) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const PatchLookup lookup_;
  const PhotonTargets targets_;
  const bool has_paths_;
  std::uint64_t seed_;
};

}  // namespace patchlight
