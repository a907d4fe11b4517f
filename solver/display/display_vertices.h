#pragma once
#include <cstdint>
#include <unordered_map>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

constexpr int kDisplayLevels = 3;  ///< How often a patch may be halved along each side.

/// Which edges of quads meet others without a crease.
class SmoothEdges {
 public:
  explicit SmoothEdges(const PatchSet& scene);

  bool is_smooth(const Primitive& primitive) const;
  /// Edges lie at v = 0, u = 1, v = 1, u = 0.
  bool is_smooth(const Primitive& primitive, int edge) const;

 private:
  std::unordered_map<std::uint64_t, int> count_;
};

/// Gives the leaves of a mesh their corners: those of neighbours are one vertex. Leaves some of whose corners are much
/// less exposed than others are cut.
void add_display_vertices(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                          const SmoothEdges& smooth, DisplayMesh& mesh);

}  // namespace patchlight
