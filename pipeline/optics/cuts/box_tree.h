#pragma once
#include <ImathBox.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// A bounding volume hierarchy over boxes with edges along the axes, m. It finds the boxes that overlap a given one.
class BoxTree {
 public:
  /// `boxes`: numbered by their indices.
  explicit BoxTree(const std::vector<Imath::Box3d>& boxes);
  ~BoxTree();
  BoxTree(const BoxTree&) = delete;
  BoxTree& operator=(const BoxTree&) = delete;

  /// Indices of the boxes that overlap `box`, in no order.
  std::vector<std::int32_t> overlapping(const Imath::Box3d& box) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace patchlight
