#include "pipeline/optics/intersect/alpha_mask.h"

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {

bool passes_alpha_test(const PatchSet& scene, std::int32_t i, double u, double v) {
  const Primitive& primitive = scene.primitives[i];
  const Material& material = scene.materials[primitive.material];
  const float mask = mask_value(scene.masks[primitive.mask], texcoord_at(scene, i, u, v));
  return material.alpha * mask * vertex_color(scene, i, u, v).w >= material.alpha_cutoff;
}

Vec2f covered_point(const PatchSet& scene, const Patch& patch, const PatchSampler& sampler, Vec2f at,
                    std::uint64_t random) {
  constexpr int kMaxTries = 64;
  for (int k = 0; k < kMaxTries; ++k) {
    const Imath::V2d uv = sampler.place(at.x, at.y).uv;
    if (passes_alpha_test(scene, patch.primitive, uv.x, uv.y)) return at;
    random = hash64(random + 1);
    at = Vec2f(uniform01(random), uniform01(hash64(random)));
  }
  return at;
}

}  // namespace patchlight
