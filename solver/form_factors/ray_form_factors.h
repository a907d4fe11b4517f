#pragma once
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "solver/form_factors/form_factors.h"

namespace patchlight {

/// Form factors by rays: of a patch's rays, leaving it uniformly over its area and with the density cos / pi over the
/// hemisphere, the part that ends on patch j estimates F_ij without bias (Malley 1988). Points and directions follow a
/// four-dimensional Kronecker sequence, shifted at random for each patch.
class RayFormFactors : public FormFactorSource {
 public:
  RayFormFactors(const PatchSet& scene, std::uint64_t seed);

  /// For every ray of every shot, in order, the patch that it ends on: -1 for what escapes or meets an unlit back.
  /// Shape: [sum of the shots' rays]. The same for any number of threads.
  std::vector<std::int32_t> cast(std::span<const Shot> shots) const;

  std::size_t batch(std::span<const Shot> shots) const override;
  std::vector<std::span<const FormFactor>> rows(std::span<const Shot> shots) override;

 private:
  void cast_packets(const Shot& shot, std::uint32_t first, std::uint32_t last, std::int32_t* columns) const;

  const PatchSet& scene_;
  std::uint64_t seed_;
  RayScene ray_scene_;
  PatchLookup lookup_;
  std::vector<FormFactor> factors_;
};

}  // namespace patchlight
