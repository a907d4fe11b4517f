#pragma once
#include <tbb/enumerable_thread_specific.h>

#include <optional>

#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/surface/material_shader.h"
#include "tracer/light/solution/display_lookup.h"

namespace patchlight {

/// The mixes of light groups that a frame needs.
struct LightMixes {
  std::vector<LightMix> all;    ///< The first holds the lights' settings.
  std::size_t unscaled = 0;     ///< Index of the mix of all groups at the scene's own strength.
  std::size_t first_group = 0;  ///< Index of the first single group at the scene's own strength; 0: not asked for.

  LightMixes(const std::vector<Color>& settings, bool by_group);
};

/// Colours and irradiance of the solution at hits on the lit sides of surfaces.
class SolvedSurfaces {
 public:
  /// `smooth`: of the scene's primitives.
  SolvedSurfaces(const PatchSet& scene, const EnergyField& energy, const LightMixes& mixes, const TraceConfig& config,
                 const SmoothEdges& smooth);

  const PatchLookup& lookup() const { return lookup_; }

  struct Colors {
    std::int32_t patch = 0;
    std::int32_t group = -1;  ///< Light group of the emission; -1: none.
    Color reflectance{0.0f};  ///< Diffuse, of the patch, a texture or a shader, clamped to the valid range.
    Color emission{0.0f};     ///< Radiant exitance at the scene's own strength, W/m2.
  };
  Colors colors(const SurfaceHit& hit) const {
    const Primitive& primitive = scene_.primitives[hit.primitive];
    const std::int32_t i = lookup_.patch(hit.primitive, hit.u, hit.v);
    Colors colors{i, primitive.light_group, scene_.patches[i].reflectance, scene_.patches[i].emission};
    if (varying_[hit.primitive]) evaluate_colors(hit, colors);
    return colors;
  }
  /// The other side of a translucent surface at a hit, and its colours there: what passes counts as its reflectance.
  SurfaceHit behind(const SurfaceHit& hit) const {
    return {scene_.primitives[hit.primitive].back, true, 1.0f - hit.u, hit.v, hit.t};
  }
  Colors passed_colors(const SurfaceHit& behind) const {
    const Material& material = scene_.materials[scene_.primitives[behind.primitive].material];
    return {lookup_.patch(behind.primitive, behind.u, behind.v), -1, material.translucence, Color(0.0f)};
  }
  /// Radiant exitance under one of the mixes, W/m2.
  Color emission(const Colors& colors, std::size_t mix = 0) const {
    return colors.group < 0 ? Color(0.0f) : colors.emission * mixes_.all[mix][colors.group];
  }

  /// Argument of irradiance() for a hit on `patch`, valid under all mixes.
  DisplayLookup::Blend blend(const SurfaceHit& hit, std::int32_t patch) const {
    return display_ ? display_->blend(hit.primitive, patch, hit.u, hit.v) : DisplayLookup::Blend{};
  }
  /// W/m2. Unless `quality` is `patches`, without the direct light of sampled emitters.
  Color irradiance(const SurfaceHit& hit, const DisplayLookup::Blend& blend, std::size_t mix = 0) const {
    return display_ ? (*display_)(blend, hit.primitive, hit.u, hit.v, mix) : patches_(hit.primitive, hit.u, hit.v, mix);
  }
  /// irradiance() plus the direct light of sampled emitters; only with `quality: gather`, or with coats.
  Color total_irradiance(const SurfaceHit& hit, const DisplayLookup::Blend& blend, std::size_t mix) const {
    return irradiance(hit, blend, mix) + (*sampled_direct_)(hit.primitive, hit.u, hit.v, mix);
  }
  /// Direct part of an irradiance() under the lights' settings. For the layers.
  Color direct_part(const SurfaceHit& hit, const Color& irradiance) const;

 private:
  /// Replaces a patch's colours by those of textures, vertex colours or a shader at the hit.
  void evaluate_colors(const SurfaceHit& hit, Colors& colors) const;

  const PatchSet& scene_;
  const LightMixes& mixes_;
  const PatchLookup lookup_;
  std::vector<std::uint8_t> varying_;  ///< [primitives]: textures, vertex colours or a shader set its colours.
  const IrradianceLookup patches_;
  std::optional<DisplayLookup> display_;
  std::optional<IrradianceLookup> direct_;          ///< Direct part of irradiance() under the lights' settings.
  std::optional<IrradianceLookup> sampled_direct_;  ///< Direct light of sampled emitters.
  mutable tbb::enumerable_thread_specific<std::vector<MaterialShader>> shaders_;
};

}  // namespace patchlight
