#include "solver/form_factors/row_scattering.h"

#include <map>

#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "solver/form_factors/coated_rows.h"

namespace patchlight {

namespace {

/// The patches on the other side of a translucent one, and the parts of it where they are.
std::map<std::int32_t, double> patches_behind(const PatchSet& scene, const PatchLookup& lookup, const Patch& patch) {
  constexpr int kAcross = 4;
  const PatchSampler sampler(scene.primitives, patch);
  std::map<std::int32_t, double> parts;
  for (int k = 0; k < kAcross * kAcross; ++k) {
    const auto at =
        sampler.place((float(k % kAcross) + 0.5f) / float(kAcross), (float(k / kAcross) + 0.5f) / float(kAcross));
    const std::int32_t behind = scene.primitives[at.primitive].back;
    if (behind >= 0) parts[lookup.patch(behind, 1.0f - float(at.uv.x), float(at.uv.y))] += 1.0 / (kAcross * kAcross);
  }
  return parts;
}

}  // namespace

Spectrum seen_by_rows(const PatchSet& scene, const Patch& patch, const Color& part, bool coats) {
  const Primitive& primitive = scene.primitives[patch.primitive];
  if (!coats || !passes_by_chance(scene, primitive)) return Spectrum(part * patch.transmittance);
  const float landing = untransmitted_part(scene, primitive);
  return Spectrum(landing > 0 ? part / landing : Color(0.0f));
}

Scattering row_scattering(const PatchSet& scene, bool coats) {
  Scattering scattering;
  scattering.albedo.reserve(scene.patches.size());
  const PatchLookup lookup(scene);
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    const Primitive& primitive = scene.primitives[patch.primitive];
    scattering.albedo.push_back(seen_by_rows(scene, patch, patch.reflectance, coats));
    if (!is_translucent(scene, primitive)) continue;
    const Spectrum passed = seen_by_rows(scene, patch, scene.materials[primitive.material].translucence, coats);
    scattering.albedo.back() += passed;
    const auto to = std::int32_t(i);
    scattering.passages.push_back({to, to, Spectrum(-1.0) * passed});
    for (const auto& [from, part] : patches_behind(scene, lookup, patch))
      scattering.passages.push_back({to, from, passed * Spectrum(part)});
  }
  return scattering;
}

}  // namespace patchlight
