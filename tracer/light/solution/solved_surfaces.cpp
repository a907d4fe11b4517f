#include "tracer/light/solution/solved_surfaces.h"

#include <algorithm>

#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {

namespace {

std::vector<Color> gathered_direct(const EnergyField::Group& group) {
  return group.gathered_direct.empty() ? std::vector<Color>(group.direct.size(), Color(0.0f)) : group.gathered_direct;
}

}  // namespace

LightMixes::LightMixes(const std::vector<Color>& settings, bool by_group) : all{settings} {
  const std::size_t count = settings.size();
  if (std::any_of(settings.begin(), settings.end(), [](const Color& c) { return c != Color(1.0f); })) {
    unscaled = all.size();
    all.emplace_back(count, Color(1.0f));
  }
  if (!by_group) return;
  first_group = all.size();
  for (std::size_t g = 0; g < count; ++g) all.emplace_back(count, Color(0.0f))[g] = Color(1.0f);
}

SolvedSurfaces::SolvedSurfaces(const PatchSet& scene, const EnergyField& energy, const LightMixes& mixes,
                               const TraceConfig& config, const SmoothEdges& smooth)
    : scene_(scene),
      mixes_(mixes),
      lookup_(scene),
      patches_(
          scene, lookup_, smooth,
          [&](std::size_t g) {
            return config.quality == "patches" ? patchlight::irradiance(energy.groups[g])
                                               : irradiance_without_sampled(energy.groups[g]);
          },
          mixes.all),
      shaders_([&scene] { return compile_shaders(scene); }) {
  varying_.reserve(scene.primitives.size());
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    const Primitive& p = scene.primitives[i];
    varying_.push_back(is_colored(scene, i) || p.shader >= 0 || p.emission_texture >= 0);
  }
  const bool direct_in_patches = config.quality == "patches";
  if (!direct_in_patches && energy.display) display_.emplace(scene, patches_, energy, mixes.all);
  const bool has_gathered = std::any_of(energy.groups.begin(), energy.groups.end(),
                                        [](const EnergyField::Group& group) { return !group.gathered_direct.empty(); });
  if (config.asks_for("direct") || config.asks_for("indirect")) {
    if (direct_in_patches)
      direct_.emplace(
          scene, lookup_, smooth, [&](std::size_t g) { return energy.groups[g].direct; },
          std::vector<LightMix>{mixes.all[0]});
    else if (has_gathered)
      direct_.emplace(
          scene, lookup_, smooth, [&](std::size_t g) { return gathered_direct(energy.groups[g]); },
          std::vector<LightMix>{mixes.all[0]});
  }
  if (config.quality == "gather" || (has_coats(scene.materials) && !direct_in_patches))
    sampled_direct_.emplace(
        scene, lookup_, smooth,
        [&](std::size_t g) {
          std::vector<Color> direct = energy.groups[g].direct;
          const std::vector<Color> gathered_part = gathered_direct(energy.groups[g]);
          for (std::size_t i = 0; i < direct.size(); ++i)
            for (int k = 0; k < 3; ++k) direct[i][k] = std::max(0.0f, direct[i][k] - gathered_part[i][k]);
          return direct;
        },
        mixes.all);
}

void SolvedSurfaces::evaluate_colors(const SurfaceHit& hit, Colors& colors) const {
  const Primitive& primitive = scene_.primitives[hit.primitive];
  if (is_colored(scene_, hit.primitive)) colors.reflectance = colored_reflectance(scene_, hit.primitive, hit.u, hit.v);
  if (primitive.emission_texture >= 0) colors.emission = textured_emission(scene_, hit.primitive, hit.u, hit.v);
  if (primitive.shader < 0) return;
  MaterialShader& shader = shaders_.local()[primitive.shader];
  if (shader.reflects()) colors.reflectance = shaded_reflectance(scene_, shader, hit.primitive, hit.u, hit.v);
  if (!shader.emits()) return;
  const ExpressionInputs at = shader_inputs(scene_, hit.primitive, hit.u, hit.v);
  colors.emission = clamp_color(shader.emission(at), Color(kMaxEmission));
}

Color SolvedSurfaces::direct_part(const SurfaceHit& hit, const Color& irradiance) const {
  if (!direct_) return Color(0.0f);
  const Color direct = (*direct_)(hit.primitive, hit.u, hit.v);
  return {std::min(direct.x, irradiance.x), std::min(direct.y, irradiance.y), std::min(direct.z, irradiance.z)};
}

}  // namespace patchlight
