#pragma once
#include <cstdint>
#include <vector>

#include "importers/mesh/surface.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Area of the exact sphere, bilinear quad or region, m2.
double primitive_area(const Primitive& primitive);

/// Number of patches that append_patches makes. Floating-point, since a tiny patch area can exceed integers.
double patch_count(const Primitive& primitive, double patch_area);

/// Numbers of patches along the edges of a quad.
struct QuadGrid {
  std::int32_t columns = 1, rows = 1;
};

/// The grid of patches of about `patch_area` m2, from the mean lengths of opposite edges; a triangle smaller than two
/// patch areas is one patch.
QuadGrid quad_grid(const Primitive& quad, double patch_area);

/// How a primitive is divided into patches.
struct PatchTarget {
  double area = 0;      ///< Of a patch, m2.
  QuadGrid grid{0, 0};  ///< Of a quad; zeros: by the area.
};

/// Subdivides a primitive into patches, in rows of ascending v, with ascending u in each row. Those of a region are the
/// parts of cells that lie in it.
///
/// Sphere: rings of equal polar angle, each subdivided by its circumference; at least 2 rings of 3 patches.
/// Areas are exact: of the bilinear surface, and R^2 dphi (cos theta1 - cos theta2).
void append_patches(const Primitive& primitive, std::int32_t index, const SurfaceMaterial& material,
                    const PatchTarget& target, std::vector<Patch>& patches);

}  // namespace patchlight
