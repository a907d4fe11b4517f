#pragma once
#include <tbb/enumerable_thread_specific.h>

#include <optional>

#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/surface/material_shader.h"
#include "tracer/light/display_lookup.h"

namespace patchlight {

/// The mixes of light groups that a frame asks for.
struct LightMixes {
  std::vector<LightMix> all;  ///< The first is the lights' settings.
  std::size_t own = 0;        ///< That of the scene's own strength.
  std::size_t groups = 0;     ///< The first of those of a single group, at the scene's own strength; 0: none.

  LightMixes(const std::vector<Color>& settings, bool by_group);
};

/// What is known of a surface where a ray meets its lit side: its colours, and the irradiance that the solution tells.
class SolvedSurfaces {
 public:
  SolvedSurfaces(const PatchSet& scene, const RayScene& ray_scene, const EnergyField& energy, const LightMixes& mixes,
                 const TraceConfig& config);

  struct Colors {
    std::int32_t patch = 0;
    std::int32_t group = -1;  ///< Of its emission; -1: none.
    Color reflectance{0.0f};  ///< Diffuse: of the patch, or by texture or shader, brought into range.
    Color emission{0.0f};     ///< Radiant exitance at the scene's own strength, W/m2.
  };
  Colors colors(const SurfaceHit& hit) const {
    const Primitive& primitive = scene_.primitives[hit.primitive];
    const std::int32_t i = lookup_.patch(hit.primitive, hit.u, hit.v);
    Colors colors{i, primitive.light_group, scene_.patches[i].reflectance, scene_.patches[i].emission};
    if (varied_[hit.primitive]) vary(hit, colors);
    return colors;
  }
  /// Exitance under one of the mixes, W/m2.
  Color emission(const Colors& colors, std::size_t mix = 0) const {
    return colors.group < 0 ? Color(0.0f) : colors.emission * mixes_.all[mix][colors.group];
  }

  /// For irradiance() at a hit on a patch, under all mixes. `seen`: of places near it.
  DisplayLookup::Blend blend(const SurfaceHit& hit, std::int32_t patch, DisplayLookup::Seen& seen) const {
    return display_ ? display_->blend(hit.primitive, patch, hit.u, hit.v, seen) : DisplayLookup::Blend{};
  }
  /// W/m2. Unless `quality` is `patches` it lacks what comes straight from emitters that are sampled apart.
  Color irradiance(const SurfaceHit& hit, const DisplayLookup::Blend& blend, std::size_t mix = 0) const {
    return display_ ? (*display_)(blend, hit.primitive, hit.u, hit.v, mix) : patches_(hit.primitive, hit.u, hit.v, mix);
  }
  /// All of it; only with `quality: gather`.
  Color all_irradiance(const SurfaceHit& hit, const DisplayLookup::Blend& blend, std::size_t mix) const {
    return irradiance(hit, blend, mix) + (*explicit_)(hit.primitive, hit.u, hit.v, mix);
  }
  /// How much of an irradiance that was told under the lights' settings came straight from emitters. For the layers.
  Color direct_part(const SurfaceHit& hit, const Color& irradiance) const;

 private:
  /// Replaces a patch's colours by those of a texture or a shader.
  void vary(const SurfaceHit& hit, Colors& colors) const;

  const PatchSet& scene_;
  const LightMixes& mixes_;
  const PatchLookup lookup_;
  std::vector<std::uint8_t> varied_;  ///< By primitive: textures, vertices or a shader vary its colours.
  const IrradianceLookup patches_;
  std::optional<DisplayLookup> display_;
  std::optional<IrradianceLookup> direct_;    ///< Of what irradiance() tells, under the lights' settings.
  std::optional<IrradianceLookup> explicit_;  ///< Of emitters that are sampled apart, straight.
  mutable tbb::enumerable_thread_specific<std::vector<MaterialShader>> shaders_;
};

}  // namespace patchlight
