#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/lights/sky.h"
#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

/// Numbers of the elements that rays end on: first the patches; then the display mesh's elements, which replace
/// subdivided patches: one per leaf, and four per cut leaf, one for each corner; last the cells of the environment. A
/// hit on a cut leaf belongs to the nearest corner that is visible from it, on an 8 x 8 grid; hidden corners come last.
class Elements {
 public:
  explicit Elements(const PatchSet& scene)
      : scene_(scene), lookup_(scene), first_sky_(std::int32_t(scene.patches.size())) {}
  Elements(const PatchSet& scene, const RayScene& ray_scene, const DisplayMesh& mesh);

  /// The element at (u,v) of primitive `i`.
  std::int32_t at(std::int32_t i, float u, float v) const {
    const std::int32_t patch = lookup_.patch(i, u, v);
    if (!mesh_ || mesh_->roots[patch] < 0) return patch;
    const DisplayMesh::Place place = mesh_->find(patch, scene_.patches[patch], u, v);
    const std::int32_t first = std::int32_t(scene_.patches.size()) + place.leaf->leaf;
    return place.leaf->cut ? first + nearest_corner(place) : first;
  }

  /// The element of a ray in this direction that hits no surface; -1 without an environment.
  std::int32_t sky(const Vec3f& direction) const {
    return scene_.environment ? first_sky_ + sky_cell(*scene_.environment, direction) : -1;
  }

  bool is_sky(std::int32_t element) const { return element >= first_sky_; }

 private:
  static constexpr int kLeafGrid = 8;
  using Nearest = std::array<std::uint8_t, kLeafGrid * kLeafGrid>;  ///< Corner of each grid cell of a leaf.

  int nearest_corner(const DisplayMesh::Place& place) const {
    const int x = std::min(int(place.u * kLeafGrid), kLeafGrid - 1),
              y = std::min(int(place.v * kLeafGrid), kLeafGrid - 1);
    return nearest_corners_[cut_leaf_index_[place.leaf - mesh_->cells.data()]][y * kLeafGrid + x];
  }

  const PatchSet& scene_;
  const PatchLookup lookup_;
  const DisplayMesh* const mesh_ = nullptr;
  const std::int32_t first_sky_;
  std::vector<std::int32_t> cut_leaf_index_;  ///< [cells] Index into `nearest_corners_`; -1: not a cut leaf.
  std::vector<Nearest> nearest_corners_;
};

/// Visibility between up to four points (u,v) of primitive `i`, in a leaf, and the leaf's corners: four bits per point,
/// the first point lowest. Hidden corners count as invisible.
std::uint32_t visible_corners(const PatchSet& scene, const RayScene& ray_scene, const DisplayMesh& mesh,
                              const DisplayMesh::Cell& leaf, std::int32_t i, std::span<const Vec2f> places);

/// The part of a patch in this (u,v) range of its primitive, as a patch.
Patch sub_patch(const PatchSet& scene, const Patch& patch, float u0, float v0, float u1, float v1);

/// The quarters of a patch, in rows of growing u.
std::array<Patch, 4> quarters(const PatchSet& scene, const Patch& patch);

/// Calls act(element, part) for each element of a patch's leaves, as a patch with the same colours. Elements of cut
/// leaves are corners without area.
void for_each_leaf(const PatchSet& scene, const DisplayMesh& mesh, std::size_t patch,
                   const std::function<void(std::int32_t, const Patch&)>& act);

/// All elements of leaves as patches. Shape: [mesh.elements].
std::vector<Patch> leaf_patches(const PatchSet& scene, const DisplayMesh& mesh);

}  // namespace patchlight
