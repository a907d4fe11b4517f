#pragma once
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "solver/form_factors/form_factors.h"

namespace patchlight {

/// Form factors by ray casting: the fraction of a patch's rays that hit patch j is an unbiased estimate of F_ij (Malley
/// 1988). Origins are uniform over the patch's area, directions have the density cos / pi. Both follow a
/// four-dimensional Kronecker sequence with a random shift for each patch.
class RayFormFactors : public FormFactorSource {
 public:
  RayFormFactors(const PatchSet& scene, std::uint64_t seed);

  /// The patch that each ray of each shot hits, in order; -1 for a ray that escapes or hits an unlit back.
  /// Shape: [sum of the shots' rays]. The result does not depend on the number of threads.
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
