#pragma once
#include <cstdint>
#include <vector>

#include "importers/mesh/surface.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// True area of a primitive, m2: of the sphere, or of the bilinear quad.
double primitive_area(const Primitive& primitive);

/// Number of patches that append_patches makes; a float, since a tiny patch area asks for more than can be counted.
double patch_count(const Primitive& primitive, double patch_area);

/// Cuts a primitive into patches of about `patch_area` m2, in rows of growing v, growing u within a row.
///
/// Quad: columns and rows as the mean lengths of its opposite edges ask for; a triangle below two patch areas stays
/// whole. Sphere: rings of equal polar angle, each with as many patches as its circumference asks for, at least 2 rings
/// of 3. Areas are exact: a quad's true surface area, a sphere's R^2 dphi (cos theta1 - cos theta2).
void append_patches(const Primitive& primitive, std::int32_t index, const SurfaceMaterial& material, double patch_area,
                    std::vector<Patch>& patches);

}  // namespace patchlight
