#include "pipeline/optics/intersect/alpha_mask.h"

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {

float alpha_at(const PatchSet& scene, std::int32_t i, double u, double v) {
  const Primitive& primitive = scene.primitives[i];
  const float mask = mask_value(scene.masks[primitive.mask], texcoord_at(scene, i, u, v));
  return scene.materials[primitive.material].alpha * mask * vertex_color(scene, i, u, v).w;
}

bool passes_alpha_test(const PatchSet& scene, std::int32_t i, double u, double v, float chance) {
  const float cutoff = scene.materials[scene.primitives[i].material].alpha_cutoff;
  const float alpha = alpha_at(scene, i, u, v);
  return cutoff > 0 ? alpha >= cutoff : alpha > chance;
}

Vec2f covered_point(const PatchSet& scene, const Patch& patch, const PatchSampler& sampler, Vec2f at,
                    std::uint64_t random) {
  constexpr int kMaxTries = 64;
  for (int k = 0; k < kMaxTries; ++k) {
    const Imath::V2d uv = sampler.place(at.x, at.y).uv;
    if (passes_alpha_test(scene, patch.primitive, uv.x, uv.y, uniform01(hash64(~random)))) return at;
    random = hash64(random + 1);
    at = Vec2f(uniform01(random), uniform01(hash64(random)));
  }
  return at;
}

}  // namespace patchlight
