#pragma once
#include "tests/patch_scene.h"
#include "tracer/light/integrator.h"

namespace patchlight::test {

/// A scene with a made-up solution: every patch receives `direct` and `indirect`, W/m2, from each light group.
struct Solved {
  PatchSet scene;
  EnergyField energy;
  Job job;
  Camera camera;

  explicit Solved(PatchScene& builder, float direct = 2.0f, float indirect = 1.0f) : scene(builder.get()) {
    const std::size_t n = scene.patches.size();
    for (const std::string& group : scene.light_groups)
      energy.groups.push_back({group, std::vector<Color>(n, Color(direct)), std::vector<Color>(n, Color(indirect))});
    job.trace.resolution = {8, 8};
    job.trace.samples = 4;
    job.trace.quality = "patches";
  }

  Image render() const {
    Progress progress({"test", true, ""});
    return Integrator(scene, energy, job).render(camera, progress);
  }
};

}  // namespace patchlight::test
