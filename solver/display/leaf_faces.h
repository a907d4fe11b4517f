#pragma once
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/cuts/crossings.h"
#include "pipeline/optics/surface/lattices.h"
#include "pipeline/optics/surface/smooth_edges.h"
#include "solver/display/seams.h"

namespace patchlight {

/// Cuts a mesh's leaves into faces along `crossings` [primitives], and adds the vertices at the faces' corners. Faces
/// share vertices unless another surface stands between them. `is_open` [patches]: whether a patch has vertices that
/// gather light.
void add_faces(const PatchSet& scene, const PatchLookup& lookup, const Lattices& lattices, const Seams& seams,
               const SmoothEdges& smooth, const std::vector<std::vector<Crossing>>& crossings,
               const std::vector<bool>& is_open, DisplayMesh& mesh);

}  // namespace patchlight
