#pragma once
#include "pipeline/model/transport.h"
#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/surface/coat_albedo.h"
#include "solver/linear/spectrum.h"

namespace patchlight {

/// What coats reflect of the direct light of sampled emitters, which rows do not find by way of coats: as much as they
/// reflect of light from the emitter's middle, spread like diffuse light. Nothing on partly metallic patches, where
/// photons bring it.
class CoatLight {
 public:
  /// `lights`: of the scene's patches.
  CoatLight(const PatchSet& scene, const LightRows& lights);

  /// Whether there are any coats.
  bool any() const { return coats_.any(); }

  /// Exitance over the irradiance of an emitter, for rays of rows that pass the coat of a patch.
  Spectrum factor(const Emitter& emitter, std::size_t patch) const;

  /// The same of all emitters that a LightTree chose.
  Spectrum further_factor(std::size_t patch) const { return further_.empty() ? mean_factor(patch) : further_[patch]; }

  /// The same of light from all directions.
  Spectrum mean_factor(std::size_t patch) const;

 private:
  /// For light that arrives at an angle of this cosine.
  Spectrum factor_at(std::size_t patch, double cosine) const;
  Spectrum for_rows(std::size_t patch, const Color& reflected) const;
  bool is_without(std::size_t patch) const;

  const PatchSet& scene_;
  const CoatAlbedos coats_;
  SpectrumField further_;  ///< [patches]; empty: no such emitters.
};

}  // namespace patchlight
