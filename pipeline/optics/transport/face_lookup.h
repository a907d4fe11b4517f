#pragma once
#include <functional>
#include <vector>

#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/model/display_mesh.h"

namespace patchlight {

/// Finds the faces of a DisplayMesh.
class FaceLookup {
 public:
  FaceLookup(const PatchSet& scene, const DisplayMesh& mesh);

  /// A face, and a position in its leaf.
  struct Place {
    std::int32_t face = -1;
    bool cut = false;    ///< Whether the face is a part of its leaf.
    float u = 0, v = 0;  ///< In [0,1].
  };

  /// The face at (u,v) of a patch's primitive; -1 on a patch that is not subdivided.
  Place find(std::int32_t patch, float u, float v) const {
    if (mesh_.roots[patch] < 0) return {};
    const Patch& cell = scene_.patches[patch];
    const auto relative_position = [](float x, float low, float high) {
      const float t = (x - low) / (high - low);
      return t < 0.0f ? 0.0f : (t > 1.0f ? 1.0f : t);
    };
    float x = relative_position(u, cell.u0, cell.u1), y = relative_position(v, cell.v0, cell.v1);
    const DisplayMesh::Cell* at = &mesh_.cells[mesh_.roots[patch]];
    while (at->children >= 0) {
      const int right = x >= 0.5f, upper = y >= 0.5f;
      at = &mesh_.cells[at->children + 2 * upper + right];
      x = 2 * x - float(right);
      y = 2 * y - float(upper);
    }
    if (at->cut < 0) return {at->face, false, x, y};
    std::int32_t cut = at->cut;
    while (cut >= 0) cut = lines_[cut].sides[lines_[cut].side(u, v)];
    return {~cut, true, x, y};
  }

 private:
  const PatchSet& scene_;
  const DisplayMesh& mesh_;
  std::vector<CutLine> lines_;  ///< As DisplayMesh::cuts.
};

/// Calls act(cell, part) for each leaf with faces, with its part of its root's cell as a patch that is not cut.
void for_each_leaf(const PatchSet& scene, const DisplayMesh& mesh,
                   const std::function<void(const DisplayMesh::Cell&, const Patch&)>& act);

/// The same for each leaf that is cut, as a patch of which only the primitive and the (u,v) range are set.
void for_each_cut_leaf(const PatchSet& scene, const DisplayMesh& mesh,
                       const std::function<void(const DisplayMesh::Cell&, const Patch&)>& act);

/// All faces as patches, with the colours of theirs. Shape: [faces].
std::vector<Patch> face_patches(const PatchSet& scene, const DisplayMesh& mesh);

/// The part of a patch's cell in this (u,v) range of its primitive, as a patch that is not cut; without an area where
/// it is outside of a region.
Patch sub_patch(const PatchSet& scene, const Patch& patch, float u0, float v0, float u1, float v1);

/// The gathering vertices as patches of no size. Shape: [gathered].
std::vector<Patch> vertex_patches(const PatchSet& scene, const DisplayMesh& mesh);

/// The quarters of a cell, in rows of growing u.
std::array<Patch, 4> quarters(const PatchSet& scene, const Patch& cell);

}  // namespace patchlight
