#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

/// By light group: what its light counts for.
using LightMix = std::vector<Color>;

/// Irradiance between patch centres, W/m2, under one mix of light groups or several.
///
/// Planes: bilinear between the centres of a primitive's patches; beyond the outermost centres it goes on to the
/// patches of the primitive that meets the edge smoothly, or else linearly, never below zero. A primitive of a single
/// patch that meets others smoothly takes the means of the patches about its corners instead. Never across a crease, a
/// border of materials or between nodes, since corners share smooth vertices within those alone. Spheres: linear along
/// the two nearest rings, wrapping in u, and between them; towards a pole, to its ring's mean.
///
/// All of it holds for each light group by itself, so that a mix is the sum of its groups, wherever it is looked up.
class IrradianceLookup {
 public:
  /// What a light group causes on each patch.
  using OfGroup = std::function<std::vector<Color>(std::size_t group)>;

  IrradianceLookup(const PatchSet& scene, const PatchLookup& lookup, const OfGroup& of_group,
                   const std::vector<LightMix>& mixes);

  /// At (u,v) of primitive `i`, under one of the mixes.
  Color operator()(std::int32_t i, float u, float v, std::size_t mix = 0) const;

 private:
  /// Cells with a margin of one about them; a facet has 2 x 2 corner values and no margin.
  struct Grid {
    std::size_t first = 0;
    int columns = 0;  ///< Without the margin; 0: a sphere, -1: a facet.
    int rows = 0;
  };
  class Builder;
  /// What all patches and cells say under one mix.
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
