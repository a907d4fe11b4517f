#pragma once
#include <span>
#include <vector>

#include "pipeline/model/transport.h"
#include "solver/linear/spectrum.h"

namespace patchlight {

/// The mesh's elements, each with its patch and the vertices around it.
class LeafElements {
 public:
  LeafElements(const PatchSet& scene, const DisplayMesh& mesh)
      : cells_(mesh.cells), patch_of_(mesh.cells.size(), -1), part_of_(mesh.cells.size(), 1.0f) {
    for (std::size_t i = 0; i < scene.patches.size(); ++i)
      if (mesh.roots[i] >= 0) patch_of_[mesh.roots[i]] = std::int32_t(i);
    for (std::size_t i = 0; i < cells_.size(); ++i)
      for (int k = 0; k < 4 && cells_[i].children >= 0; ++k) {
        patch_of_[cells_[i].children + k] = patch_of_[i];
        part_of_[cells_[i].children + k] = 0.25f * part_of_[i];
      }
  }

  /// Calls act(patch, element, vertices, part): `part` of the patch, in (0,1].
  template <class Act>
  void for_each(Act act) const {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const DisplayMesh::Cell& cell = cells_[i];
      const std::span<const std::int32_t> corners(cell.corners);
      for (int k = 0; k < cell.elements(); ++k)
        act(std::size_t(patch_of_[i]), cell.leaf + k, cell.cut ? corners.subspan(k, 1) : corners,
            part_of_[i] / float(cell.elements()));
    }
  }

 private:
  const std::vector<DisplayMesh::Cell>& cells_;
  std::vector<std::int32_t> patch_of_;  ///< [cells].
  std::vector<float> part_of_;          ///< [cells] Fraction of the patch's (u,v) range.
};

/// Reflectance of the leaves' elements from textures and shaders, for patches that are not divided that of the patch.
/// Shape: [mesh.elements].
SpectrumField leaf_reflectance(const PatchSet& scene, const DisplayMesh& mesh, const LeafElements& leaves);

/// How much the mesh's vertices count on patches that are partly covered, in [0,1]: 1 if more than a quarter of their
/// rays reaches a front or the environment, or no rays start there; less if they are inside of something.
std::vector<float> exposure_of_vertices(const Transport::Display& display);

}  // namespace patchlight
