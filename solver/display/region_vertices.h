#pragma once
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

/// Moves vertices that lie outside of their region to its nearest point within their cell: in holes that are too small
/// to cut leaves, or beyond an outline of edges that are too short to.
void move_into_regions(const PatchSet& scene, const PatchLookup& lookup, std::vector<DisplayMesh::Vertex>& vertices);

}  // namespace patchlight
