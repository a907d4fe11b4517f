#include "importers/mesh/surface_boxes.h"

#include <algorithm>

namespace patchlight {
namespace {

constexpr double kContact = 1e-6;  // depth of contact over the size of the box

}  // namespace

void SurfaceBoxes::add(const TriangleSoup& soup) {
  Imath::Box3d whole;
  for (std::size_t k = 0; k + 2 < soup.positions.size(); k += 3) {
    Imath::Box3d& box = triangles_.emplace_back();
    for (std::size_t i = k; i < k + 3; ++i) box.extendBy(soup.positions[i]);
    surface_of_.push_back(static_cast<std::int32_t>(surfaces_.size()));
    whole.extendBy(box);
  }
  surfaces_.push_back(whole);
}

bool SurfaceBoxes::is_empty(std::size_t index, const std::vector<Vec3d>& lights) {
  Imath::Box3d inside = surfaces_[index];
  if (inside.isEmpty()) return false;
  const Vec3d contact(kContact * inside.size().length());
  inside.min += contact;
  inside.max -= contact;
  if (inside.isEmpty()) return false;
  if (std::ranges::any_of(lights, [&](const Vec3d& light) { return inside.intersects(light); })) return false;
  if (!tree_) tree_.emplace(triangles_);
  return std::ranges::all_of(tree_->overlapping(inside), [&](std::int32_t triangle) {
    return surface_of_[triangle] == static_cast<std::int32_t>(index) || !triangles_[triangle].intersects(inside);
  });
}

}  // namespace patchlight
