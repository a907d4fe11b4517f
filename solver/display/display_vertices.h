#pragma once
#include <cstdint>
#include <unordered_map>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

constexpr int kDisplayLevels = 3;  ///< Largest number of subdivisions of a patch.

/// Finds the edges of quads that join other quads smoothly.
class SmoothEdges {
 public:
  explicit SmoothEdges(const PatchSet& scene);

  bool is_smooth(const Primitive& primitive) const;
  /// Edges 0 to 3 are at v = 0, u = 1, v = 1, u = 0.
  bool is_smooth(const Primitive& primitive, int edge) const;

 private:
  std::unordered_map<std::uint64_t, int> count_;
};

/// Adds the vertices at the corners of a mesh's leaves, shared by neighbours. Leaves with corners of much lower
/// visibility than others are marked as cut.
void add_display_vertices(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                          const SmoothEdges& smooth, DisplayMesh& mesh);

}  // namespace patchlight
