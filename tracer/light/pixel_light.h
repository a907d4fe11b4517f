#pragma once
#include <vector>

#include "pipeline/optics/lights/direct_light.h"

namespace patchlight {

/// A point that a path of a pixel sample has come to.
struct ShadingPoint {
  std::uint32_t pixel = 0;   ///< Of the tile.
  std::int32_t surface = 0;  ///< The same for primitives that meet smoothly.
  std::int32_t primitive = 0;
  /// How a pixel sees a point: `scattered` by a rough metal, so that its other points may be anywhere.
  enum class Way : std::uint32_t { straight, mirrored, scattered };
  Way way = Way::straight;
  Vec3d position{0.0};  ///< Where shadow rays start: off the surface.
  Vec3f normal{0.0f};
  Color weight{0.0f};  ///< What the pixel gets for irradiance there, 1/sr.
};

/// The emitters of a scene that frames sample apart. How much a lamp is looked at depends on the scene's own strength,
/// not on the lights' settings: so a frame's light is the sum of its groups', each times its setting, noise included.
class PixelLight {
 public:
  struct Lamp {
    DirectLight light;
    Emitter emitter;
    std::int32_t group;
    Color own;       ///< Exitance, W/m2, or a light's strength, as the scene has it.
    Color exitance;  ///< The same under the lights' settings.

    float brightness() const { return own.x + own.y + own.z; }
    bool is_off() const { return exitance == Color(0.0f); }
  };

  /// `settings`: of the light groups.
  PixelLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings);

  const RayScene& ray_scene() const { return ray_scene_; }
  const std::vector<Lamp>& lamps() const { return lamps_; }

 private:
  const RayScene& ray_scene_;
  std::vector<Lamp> lamps_;
};

}  // namespace patchlight
