#pragma once
#include <vector>

#include "pipeline/optics/direct_light.h"

namespace patchlight {

/// A point that a path of a pixel sample has come to.
struct ShadingPoint {
  std::uint32_t pixel = 0;   ///< Of the tile.
  std::int32_t surface = 0;  ///< The same for primitives that meet smoothly.
  std::int32_t primitive = 0;
  Vec3d position{0.0};  ///< Where shadow rays start: off the surface.
  Vec3f normal{0.0f};
  Color weight{0.0f};  ///< What the pixel gets for irradiance there, 1/sr.
};

/// The emitters of a scene that frames sample apart, under the settings of the lights; without those that are off.
class PixelLight {
 public:
  struct Lamp {
    DirectLight light;
    std::int32_t primitive;
    Color exitance;

    float brightness() const { return exitance.x + exitance.y + exitance.z; }
  };

  /// `emission`: exitance of every patch, W/m2, under the settings of the lights.
  PixelLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& emission);

  const RayScene& ray_scene() const { return ray_scene_; }
  const std::vector<Lamp>& lamps() const { return lamps_; }

 private:
  const RayScene& ray_scene_;
  std::vector<Lamp> lamps_;
};

}  // namespace patchlight
