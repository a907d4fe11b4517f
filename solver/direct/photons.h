#pragma once
#include <span>

#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/stage/progress.h"
#include "solver/direct/photon_targets.h"

namespace patchlight {

/// Light of emitters that patches get by way of metals, by tracing it from the emitters (Arvo 1986): what small lamps
/// throw by mirrors is what a patch's own rays hardly ever find.
///
/// Photons leave an emitter uniformly over its area, aimed at the metals, where projection maps (Jensen 1996, section
/// 3.1) would send them too; each carries what the cosine law sends that way. They go on through metals as rays of
/// RayRows do, and leave what they carry on the front of every surface they meet after the first metal. Metals get
/// photons by the light that pilots bring them, at least some each: so nothing is left out.
class Photons {
 public:
  Photons(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed);

  /// Without metals there is nothing to shoot.
  bool has_metals() const { return targets_.count() > 0; }

  /// Irradiance of each patch by way of metals over the emitter's exitance, or a light's strength; of two independent
  /// halves of the photons, `photons` in all and somewhat more. The same for any number of threads. Shape: [2 patches],
  /// half by half of each patch. Adds the number of rays to `cast`. Throws: Error (interrupted).
  std::vector<Color> shoot(const Emitter& emitter, std::int64_t photons, std::int64_t& cast) const;

 private:
  class Source;
  struct Batch;
  struct Landed;

  float pilot_power(const Source& source, int target) const;
  std::vector<Batch> batches(const Source& source, std::int64_t photons) const;
  void start(const Source& source, const Batch& batch, std::uint32_t first, RayPacket& packet,
             std::span<Color> carried) const;
  void trace(const Source& source, const Batch& batch, std::vector<Landed>& landed, std::int64_t& cast) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const PatchLookup lookup_;
  const PhotonTargets targets_;
  std::uint64_t seed_;
};

}  // namespace patchlight
