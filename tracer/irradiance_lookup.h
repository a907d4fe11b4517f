#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/optics/patch_lookup.h"

namespace patchlight {

/// Irradiance between patch centres, W/m2.
///
/// Planes: bilinear between the centres of a primitive's patches; beyond the outermost centres it goes on to the
/// patches of the primitive that meets the edge smoothly, or else linearly, never below zero. A primitive of a single
/// patch that meets others smoothly takes the means of the patches about its corners instead. Never across a crease, a
/// border of materials or between nodes, since corners share smooth vertices within those alone. Spheres: linear along
/// the two nearest rings, wrapping in u, and between them; towards a pole, to its ring's mean.
class IrradianceLookup {
 public:
  /// `irradiance` has a value for each patch of `scene`.
  IrradianceLookup(const PatchSet& scene, const PatchLookup& lookup, const std::vector<Color>& irradiance);

  /// At (u,v) of primitive `i`.
  Color operator()(std::int32_t i, float u, float v) const;

 private:
  /// Cells with a margin of one about them; a facet has 2 x 2 corner values and no margin.
  struct Grid {
    std::size_t first = 0;
    int columns = 0;  ///< Without the margin; 0: a sphere, -1: a facet.
    int rows = 0;
  };
  class Builder;

  Color on_sphere(std::int32_t i, float u, float v) const;
  Color on_ring(const PatchLookup::Row& ring, float u) const;

  const PatchLookup& lookup_;
  const std::vector<Color>& irradiance_;
  std::vector<Grid> grids_;
  std::vector<Color> cells_;
};

}  // namespace patchlight
