#pragma once
#include <limits>
#include <optional>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "solver/direct/photon_targets.h"

namespace patchlight {

/// Where an emitter's photons start.
class PhotonSource {
 public:
  PhotonSource(const PatchSet& scene, const RayScene& ray_scene, const Emitter& emitter, std::uint64_t seed);
  PhotonSource(const PhotonSource&) = delete;
  PhotonSource& operator=(const PhotonSource&) = delete;

  struct Start {
    Vec3f origin{0.0f};  ///< In the local frame.
    Vec3f direction{0.0f};
    float weight = 0.0f;  ///< Flux for an exitance of 1 over the emitter's area, or for a light's strength of 1.
  };

  /// (x,y): in the unit square, for the direction. `from`: in the unit square, for the origin unless it is a point.
  Start start(const PhotonTargets& targets, int target, const Vec2f& from, float x, float y) const;

  const std::uint64_t random;
  const double area;

 private:
  Start start_on_ball(const PhotonTargets& targets, int target, const Vec2f& from, float x, float y) const;

  const RayScene& ray_scene_;
  const bool surface_;
  const float offset_;
  Patch surface_patch_;  ///< The union of the emitter's patches.
  std::optional<PatchSampler> sampler_;
  Light light_;
  std::optional<DirectLight> direct_light_;
  double scene_start_ = std::numeric_limits<double>::max();  ///< Lower bound along a sun's direction, m.
};

}  // namespace patchlight
