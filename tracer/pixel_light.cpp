#include "tracer/pixel_light.h"

namespace patchlight {

PixelLight::PixelLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& emission)
    : ray_scene_(ray_scene) {
  for (const Emitter& emitter : emitters_apart(scene)) {
    const Lamp lamp{{scene, ray_scene, emitter}, emitter.primitive, emission[emitter.first_patch]};
    if (lamp.brightness() > 0) lamps_.push_back(lamp);
  }
}

}  // namespace patchlight
