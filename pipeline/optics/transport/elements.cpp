#include "pipeline/optics/transport/elements.h"

#include <algorithm>

namespace patchlight {

Elements::Elements(const PatchSet& scene, const DisplayMesh* mesh)
    : scene_(scene),
      lookup_(scene),
      first_sky_(std::int32_t(scene.patches.size()) + (mesh ? mesh->elements() : 0)) {
  constexpr double kStep = 8e-6;  // over the size of the primitive; hits are rounded by less
  if (mesh) faces_.emplace(scene, *mesh);
  for (const Patch& patch : scene.patches) {
    if (patch.closed == 0 && patch.cut < 0) continue;
    steps_of_.resize(scene.primitives.size(), -1);
    if (steps_of_[patch.primitive] >= 0) continue;
    steps_of_[patch.primitive] = std::int32_t(steps_.size());
    const auto& c = scene.primitives[patch.primitive].corners;
    const Vec3d along = (c[1] - c[0] + c[2] - c[3]) * 0.5, across = (c[3] - c[0] + c[2] - c[1]) * 0.5;
    const Vec3d normal = along % across;
    const double length = kStep * std::max((c[2] - c[0]).length(), (c[3] - c[1]).length()) / (normal ^ normal);
    steps_.push_back({Vec3f((across % normal) * length), Vec3f((normal % along) * length)});
  }
}

}  // namespace patchlight
