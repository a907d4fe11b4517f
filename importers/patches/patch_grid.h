#pragma once
#include <cstdint>
#include <vector>

#include "importers/mesh/surface.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Area of the exact sphere or bilinear quad, m2.
double primitive_area(const Primitive& primitive);

/// Number of patches that append_patches makes. Floating-point, since a tiny patch area can exceed integers.
double patch_count(const Primitive& primitive, double patch_area);

/// Subdivides a primitive into patches of about `patch_area` m2, in rows of ascending v, with ascending u in each row.
///
/// Quad: columns x rows from the mean lengths of opposite edges; a triangle smaller than two patch areas is one patch.
/// Sphere: rings of equal polar angle, each subdivided by its circumference; at least 2 rings of 3 patches.
/// Areas are exact: of the bilinear surface, and R^2 dphi (cos theta1 - cos theta2).
void append_patches(const Primitive& primitive, std::int32_t index, const SurfaceMaterial& material, double patch_area,
                    std::vector<Patch>& patches);

}  // namespace patchlight
