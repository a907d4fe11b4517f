#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

/// Targets at which photons are aimed so that they hit metals and glass that turns light: each such plane of a node
/// with few of them, each such sphere, and a bounding sphere of all such planes of a node with many. Every such
/// primitive belongs to one target. A photon that first hits a surface outside its target is dropped, so no light
/// counts twice.
class PhotonTargets {
 public:
  /// `imaged`: mirrors by which emitters have virtual images; each becomes a target of its own.
  PhotonTargets(const PatchSet& scene, const RayScene& ray_scene, std::span<const PlaneMirror> imaged);

  int count() const { return int(targets_.size()); }

  /// Index of the target that a primitive belongs to; -1: none.
  std::int32_t target_of(std::int32_t primitive) const { return target_of_[primitive]; }

  /// Whether patches get the light that is reflected at the target alone by virtual images.
  bool is_imaged(int target) const { return target < imaged_; }

  struct Aim {
    Vec3f direction;      ///< Unit length.
    float weight = 0.0f;  ///< cos / (pi pdf): its mean over the unit square is the form factor to the target.
  };

  /// Samples a direction from a point of an emitter towards a target, for (x,y) in the unit square.
  Aim aim(int target, const SurfacePoint& from, float x, float y) const;

  /// The same from a point light; the mean of the weight is the target's solid angle, sr.
  Aim aim(int target, const Vec3d& from, float x, float y) const;

  struct BoundingSphere {
    Vec3d center;
    double radius;
  };
  BoundingSphere bounding_sphere(int target) const;

 private:
  struct Target {
    DirectLight light;
    bool is_sphere;  ///< A sphere may contain the emitter.
  };

  std::vector<Target> targets_;  ///< Those of imaged mirrors first.
  int imaged_;
  std::vector<std::int32_t> target_of_;  ///< [primitives]; -1: none.
};

}  // namespace patchlight
