#pragma once
#include <vector>

#include "pipeline/model/transport.h"
#include "solver/linear/scattering.h"

namespace patchlight {

/// Reflectance of the display mesh's faces: on parts of patches by textures and shaders. Shape: [faces].
SpectrumField face_reflectance(const PatchSet& scene, const DisplayMesh& mesh);

/// What passes translucent faces, towards rays of rows, from the elements on their other sides.
std::vector<Scattering::Passage> face_passages(const PatchSet& scene, const DisplayMesh& mesh);

/// How much the mesh's vertices count on patches that are partly covered, in [0,1]: 1 if more than a quarter of their
/// rays reaches a front or the environment, or no rays start there; less if they are inside of something.
std::vector<float> exposure_of_vertices(const Transport::Display& display);

}  // namespace patchlight
