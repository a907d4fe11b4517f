#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

/// What photons are aimed at so that they meet metals: each metallic plane of a node that has few, the ball of each
/// sphere, and a ball about all metallic planes of a node that has many. Every metallic primitive is of one target; a
/// photon for a target that first meets something else is lost, so that no light counts twice.
class PhotonTargets {
 public:
  PhotonTargets(const PatchSet& scene, const RayScene& ray_scene);

  int count() const { return int(targets_.size()); }

  /// The target that a primitive belongs to; -1: it is no metal.
  std::int32_t of(std::int32_t primitive) const { return of_[primitive]; }

  struct Aim {
    Vec3f direction;      ///< Unit length.
    float weight = 0.0f;  ///< cos / (pi pdf): its mean over the unit square is the form factor to what is aimed at.
  };

  /// From a point of an emitter towards a target, for (x,y) of the unit square.
  Aim aim(int target, const SurfacePoint& from, float x, float y) const;

  /// The same from a point that shines all around; the weight's mean is a solid angle.
  Aim aim(int target, const Vec3d& from, float x, float y) const;

  /// A ball about a target.
  struct Ball {
    Vec3d center;
    double radius;
  };
  Ball ball(int target) const;

 private:
  struct Target {
    DirectLight light;
    bool ball;  ///< May hold the emitter.
  };

  std::vector<Target> targets_;
  std::vector<std::int32_t> of_;  ///< By primitive.
};

}  // namespace patchlight
