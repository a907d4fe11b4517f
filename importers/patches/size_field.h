#pragma once
#include <ImathBox.h>

#include <cstdint>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// How small patches must be beside others: as small as theirs where they are, and larger with the distance, so that a
/// surface's patches have the sizes of what is near.
class SizeField {
 public:
  /// `patch_areas`: of each primitive, m2.
  SizeField(const std::vector<Primitive>& primitives, const std::vector<double>& patch_areas);

  /// The least size of patches on a plane rectangle, m, but not more than `most`. What lies in its plane or behind it
  /// does not count, unless it is `two_sided`.
  double at(const std::array<Vec3d, 4>& corners, bool two_sided, double most) const;

 private:
  /// Size of patches that a primitive asks for, and the distance from it from which on they may be larger, m.
  struct Wanted {
    double size, reach;

    double at(double distance) const;
  };
  struct Node {
    Imath::Box3d box;
    Wanted least;                   ///< Of its primitives.
    std::int32_t first, count = 0;  ///< Primitives of a leaf in order_, or the first of two children.
  };
  struct Place;

  void build(std::int32_t node, std::int32_t first, std::int32_t last);
  void visit(const Place& place, std::int32_t node, double& least) const;

  std::vector<Imath::Box3d> boxes_;  ///< Of primitives.
  std::vector<Wanted> wanted_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace patchlight
