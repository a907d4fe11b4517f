#pragma once
#include <ImathBox.h>

#include <optional>
#include <vector>

#include "importers/mesh/mesh_topology.h"
#include "pipeline/optics/cuts/box_tree.h"

namespace patchlight {

/// Finds surfaces whose backs no light can reach: closed ones that look outwards, with nothing inside.
class HiddenBacks {
 public:
  /// Takes the triangles of the next surface.
  void add(const TriangleSoup& soup);

  /// Whether nothing of the others and none of `lights`, the places of lamps without a surface, is in the box about
  /// surface `index`. Surfaces in contact with the box do not count.
  bool is_empty(std::size_t index, const std::vector<Vec3d>& lights);

 private:
  std::vector<Imath::Box3d> triangles_;
  std::vector<std::int32_t> surface_of_;  ///< [triangles]
  std::vector<Imath::Box3d> surfaces_;
  std::optional<BoxTree> tree_;  ///< Of the triangles, once it is needed.
};

/// Whether all parts of a mesh are closed and look outwards.
bool is_body(const MeshTopology& topology);

}  // namespace patchlight
