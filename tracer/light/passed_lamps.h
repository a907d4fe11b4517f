#pragma once
#include "tracer/light/camera_path.h"
#include "tracer/light/solution/solved_surfaces.h"

namespace patchlight {

/// The light of intangible lamps that camera paths pass on their way.
class PassedLamps {
 public:
  /// `glossy_lights`: not null if the scene has rough metals.
  PassedLamps(const PatchSet& scene, const SolvedSurfaces& surfaces, const LightMixes& mixes,
              const GlossyLights* glossy_lights);

  /// Adds the light of the lamps before the hits of a packet's rays.
  void add(const RayPacket& packet, std::array<CameraPath, RayPacket::kSize>& paths, PathSums& sums) const;

 private:
  void add_emission(const SurfaceHit& hit, const Vec3f& direction, int lane, CameraPath& path, PathSums& sums) const;

  const PatchSet& scene_;
  const RayScene lamps_;
  const SolvedSurfaces& surfaces_;
  const LightMixes& mixes_;
  const GlossyLights* const glossy_lights_;
};

}  // namespace patchlight
