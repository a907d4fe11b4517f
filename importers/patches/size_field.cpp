#include "importers/patches/size_field.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patchlight {
namespace {

constexpr double kGrowth = 0.3;             // of the size of patches, over the distance
constexpr double kReach = 0.25;             // of a primitive\'s extent: distance from which on sizes grow
constexpr double kPositionRounding = 1e-6;  // of positions, over their coordinates
constexpr std::int32_t kLeafCount = 4;      // primitives of a leaf

double largest_coordinate(const Imath::Box3d& box) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(box.min[k]), std::abs(box.max[k])});
  return largest;
}

}  // namespace

double SizeField::Wanted::at(double distance) const {
  return size + kGrowth * std::max(0.0, distance - reach);
}

/// A rectangle that asks for its size.
struct SizeField::Place {
  Imath::Box3d box;
  Vec3d point, normal;
  bool two_sided;

  /// From the rectangle to a box, m; infinite if nothing in the box counts.
  double distance(const Imath::Box3d& other) const {
    const Vec3d half = other.size() * 0.5;
    const double middle = (other.center() - point) ^ normal;
    const double reach = std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z;
    const double rounding = kPositionRounding * std::max(largest_coordinate(other), largest_coordinate(box));
    const double above = middle + reach, below = reach - middle;
    if (above <= rounding && (!two_sided || below <= rounding)) return std::numeric_limits<double>::infinity();
    if (!two_sided && above <= rounding) return std::numeric_limits<double>::infinity();
    Vec3d gap(0.0);
    for (int k = 0; k < 3; ++k) gap[k] = std::max({0.0, other.min[k] - box.max[k], box.min[k] - other.max[k]});
    return std::max(gap.length(), std::abs(middle) - reach);
  }
};

SizeField::SizeField(const std::vector<Primitive>& primitives, const std::vector<double>& patch_areas)
    : order_(primitives.size()) {
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    boxes_.push_back(bounds_of({primitives[i]}));
    wanted_.push_back({std::sqrt(patch_areas[i]), kReach * boxes_.back().size().length()});
  }
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.emplace_back();
  build(0, 0, std::int32_t(order_.size()));
}

void SizeField::build(std::int32_t node, std::int32_t first, std::int32_t last) {
  Imath::Box3d box, centers;
  Wanted least{std::numeric_limits<double>::infinity(), 0.0};
  for (std::int32_t k = first; k < last; ++k) {
    box.extendBy(boxes_[order_[k]]);
    centers.extendBy(boxes_[order_[k]].center());
    least.size = std::min(least.size, wanted_[order_[k]].size);
    least.reach = std::max(least.reach, wanted_[order_[k]].reach);
  }
  nodes_[node] = {box, least, first, last - first};
  if (last - first <= kLeafCount) return;
  const auto axis = centers.majorAxis();
  const std::int32_t middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::int32_t a, std::int32_t b) {
                     const double x = boxes_[a].center()[axis], y = boxes_[b].center()[axis];
                     return x != y ? x < y : a < b;
                   });
  const auto children = std::int32_t(nodes_.size());
  nodes_[node].first = children;
  nodes_[node].count = 0;
  nodes_.resize(nodes_.size() + 2);
  build(children, first, middle);
  build(children + 1, middle, last);
}

double SizeField::at(const std::array<Vec3d, 4>& corners, bool two_sided, double most) const {
  Place place{{}, corners[0], (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalized(), two_sided};
  for (const Vec3d& corner : corners) place.box.extendBy(corner);
  double least = most;
  visit(place, 0, least);
  return least;
}

void SizeField::visit(const Place& place, std::int32_t node, double& least) const {
  const Node& at = nodes_[node];
  if (at.least.at(place.distance(at.box)) >= least) return;
  if (at.count == 0) {
    const bool second = place.distance(nodes_[at.first + 1].box) < place.distance(nodes_[at.first].box);
    visit(place, at.first + second, least);
    visit(place, at.first + !second, least);
  }
  for (std::int32_t k = at.first; k < at.first + at.count; ++k)
    least = std::min(least, wanted_[order_[k]].at(place.distance(boxes_[order_[k]])));
}

}  // namespace patchlight
