#include "pipeline/optics/cuts/box_tree.h"

#include <Eigen/Geometry>
#include <numeric>
#include <unsupported/Eigen/BVH>

namespace patchlight {

namespace {

using Box = Eigen::AlignedBox3d;

Box to_eigen(const Imath::Box3d& box) {
  return {Eigen::Vector3d(box.min.x, box.min.y, box.min.z), Eigen::Vector3d(box.max.x, box.max.y, box.max.z)};
}

/// Collects the boxes that overlap a box.
struct Overlaps {
  const Box& box;
  const std::vector<Box>& boxes;
  std::vector<std::int32_t> found{};

  bool intersectVolume(const Box& volume) const { return volume.intersects(box); }
  bool intersectObject(std::int32_t i) {
    if (boxes[i].intersects(box)) found.push_back(i);
    return false;
  }
};

}  // namespace

struct BoxTree::Tree {
  std::vector<Box> boxes;
  Eigen::KdBVH<double, 3, std::int32_t> nodes{};
};

BoxTree::BoxTree(const std::vector<Imath::Box3d>& boxes) : tree_(std::make_unique<Tree>()) {
  for (const Imath::Box3d& box : boxes) tree_->boxes.push_back(to_eigen(box));
  std::vector<std::int32_t> numbers(boxes.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  tree_->nodes.init(numbers.begin(), numbers.end(), tree_->boxes.begin(), tree_->boxes.end());
}

BoxTree::~BoxTree() = default;

std::vector<std::int32_t> BoxTree::overlapping(const Imath::Box3d& box) const {
  const Box sought = to_eigen(box);
  Overlaps overlaps{sought, tree_->boxes};
  Eigen::BVIntersect(tree_->nodes, overlaps);
  return std::move(overlaps.found);
}

}  // namespace patchlight
