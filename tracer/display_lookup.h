#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/ray_scene.h"
#include "tracer/irradiance_lookup.h"

namespace patchlight {

/// Irradiance of the display solution, W/m2: on the patches that a DisplayMesh cuts, bilinear between the corners of
/// its leaves, on others between patches.
///
/// Where something stands between a leaf's corners, those that a point does not see have no say.
class DisplayLookup {
 public:
  /// `patches` holds the same light; `settings` are by light group.
  DisplayLookup(const PatchSet& scene, const RayScene& ray_scene, const IrradianceLookup& patches,
                const EnergyField& energy, const std::vector<Color>& settings);

  /// At (u,v) of primitive `i`, which lies on patch `patch`.
  Color operator()(std::int32_t i, std::int32_t patch, float u, float v) const;

 private:
  Color within(const DisplayMesh::Place& place, std::int32_t i, float u, float v) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const IrradianceLookup& patches_;
  const DisplayMesh& mesh_;
  std::vector<Color> irradiance_;  ///< [vertices].
};

}  // namespace patchlight
