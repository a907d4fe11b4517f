#pragma once
#include <vector>

#include "pipeline/optics/lights/direct_light.h"
#include "tracer/output/seen_by.h"

namespace patchlight {

/// A point of a camera path where direct light is to be added.
struct ShadingPoint {
  std::uint32_t pixel = 0;  ///< Index in the tile.
  /// Surface id; primitives that meet smoothly share one. Through a lens: of the surface's points of this reflectance.
  std::int32_t surface = 0;
  std::int32_t primitive = 0;
  SeenBy seen_by = SeenBy::itself;
  bool scattered = false;  ///< A rough surface is on the camera's path: those of one pixel may end anywhere.
  Vec3d position{0.0};     ///< Origin of shadow rays, offset from the surface.
  Vec3f normal{0.0f};
  Color weight{0.0f};       ///< Radiance of the pixel for unit irradiance at the point, 1/sr.
  Vec3f before_turn{0.0f};  ///< The shading normal if `normal` was turned to be valid for the viewer; otherwise zero.
};

/// The explicitly sampled emitters of a scene, under the lights' settings. Sampling depends on the scene's own strength
/// and not on the settings, so a frame is the sum of its light groups, each times its setting, noise included.
class ExplicitLights {
 public:
  struct Lamp {
    DirectLight light;
    Emitter emitter;
    std::int32_t group;
    Color unscaled;  ///< Exitance at the scene's own strength, W/m2; for a Light, its strength.
    Color exitance;  ///< `unscaled` times the group's setting.

    float brightness() const { return unscaled.x + unscaled.y + unscaled.z; }
    bool is_off() const { return exitance == Color(0.0f); }
  };

  /// `settings`: of the light groups.
  ExplicitLights(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings);

  const RayScene& ray_scene() const { return ray_scene_; }
  const std::vector<Lamp>& lamps() const { return lamps_; }

 private:
  const RayScene& ray_scene_;
  std::vector<Lamp> lamps_;
};

}  // namespace patchlight
