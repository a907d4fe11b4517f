#pragma once
#include <ImathBox.h>

#include <optional>
#include <vector>

#include "importers/mesh/surface.h"
#include "pipeline/optics/cuts/box_tree.h"

namespace patchlight {

/// The boxes about the triangles of all surfaces of a scene, with edges along the axes.
class SurfaceBoxes {
 public:
  /// Takes the triangles of the next surface.
  void add(const TriangleSoup& soup);

  /// Whether none of `lights`, places in m, and no box of the triangles of others is in the box about surface `index`;
  /// those in contact with it do not count.
  bool is_empty(std::size_t index, const std::vector<Vec3d>& lights);

 private:
  std::vector<Imath::Box3d> triangles_;
  std::vector<std::int32_t> surface_of_;  ///< [triangles]
  std::vector<Imath::Box3d> surfaces_;
  std::optional<BoxTree> tree_;  ///< Of the triangles, once it is needed.
};

}  // namespace patchlight
