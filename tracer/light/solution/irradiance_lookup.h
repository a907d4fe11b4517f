#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/optics/surface/smooth_edges.h"

namespace patchlight {

/// Factors of the light groups. Shape: [light groups].
using LightMix = std::vector<Color>;

/// Irradiance interpolated between patch centres, W/m2, under one or more mixes of light groups.
///
/// Quads: bilinear between the centres of a primitive's patches. Beyond the outermost centres it interpolates towards
/// the patches of the primitive that continues the grid or meets the edge smoothly, or extrapolates linearly, never
/// below zero. A quad of a
/// single patch that meets others smoothly is bilinear between its corners, each the mean of the patches around it.
/// Nothing is interpolated across creases. Spheres:
/// linear along the two nearest rings, wrapping in u, and between them; at a pole, the mean of the last ring.
///
/// Each light group is interpolated separately, so a mix is the exact sum of its groups everywhere.
class IrradianceLookup {
 public:
  /// Irradiance of each patch by one light group, W/m2. Shape of the result: [patches].
  using GroupIrradiance = std::function<std::vector<Color>(std::size_t group)>;

  /// `smooth`: of the scene's primitives.
  IrradianceLookup(const PatchSet& scene, const PatchLookup& lookup, const SmoothEdges& smooth,
                   const GroupIrradiance& group_irradiance, const std::vector<LightMix>& mixes);

  /// At (u,v) of primitive `i`, under one of the mixes.
  Color operator()(std::int32_t i, float u, float v, std::size_t mix = 0) const;

 private:
  /// Cells with a margin of one cell; a facet has 2 x 2 corner values and no margin.
  struct Grid {
    std::size_t first = 0;
    int columns = 0;  ///< Without the margin; 0: a sphere, -1: a facet.
    int rows = 0;
  };
  class Builder;
  /// Irradiance of all patches and cells under one mix.
  struct Values {
    std::vector<Color> patches;
    std::vector<Color> cells;
  };

  Color on_sphere(std::int32_t i, float u, float v, const Values& values) const;
  Color on_ring(const PatchLookup::Row& ring, float u, const Values& values) const;

  const PatchLookup& lookup_;
  std::vector<Grid> grids_;
  std::vector<Values> mixes_;
};

}  // namespace patchlight
