#include "tracer/light/lamps/explicit_lights.h"

namespace patchlight {

ExplicitLights::ExplicitLights(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings)
    : ray_scene_(ray_scene) {
  for (const Emitter& emitter : explicit_emitters(scene)) {
    const bool is_light = emitter.light >= 0;
    const std::int32_t group =
        is_light ? scene.lights[emitter.light].light_group : scene.primitives[emitter.primitive].light_group;
    const Color unscaled =
        is_light ? scene.lights[emitter.light].strength : scene.patches[emitter.first_patch].emission;
    const Lamp lamp{{scene, ray_scene, emitter}, emitter, group, unscaled, unscaled * settings[group]};
    if (lamp.brightness() > 0) lamps_.push_back(lamp);
  }
}

}  // namespace patchlight
