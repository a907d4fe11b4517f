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

/// What rays may end on, by number: the patches, and behind them what stands for those that a display mesh cuts: its
/// leaves, and of leaves that something stands on, the corner that is nearest among those which a place sees, to an
/// eighth of the leaf. A hidden corner stands for nothing that another could: what rays end on is not covered. Behind
/// all these, the cells of the environment.
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

  /// What a ray in this direction ends on that meets nothing; -1 without an environment.
  std::int32_t sky(const Vec3f& direction) const {
    return scene_.environment ? first_sky_ + sky_cell(*scene_.environment, direction) : -1;
  }

 private:
  static constexpr int kAcross = 8;
  using Nearest = std::array<std::uint8_t, kAcross * kAcross>;  ///< Corners, of the parts of a leaf.

  int nearest_corner(const DisplayMesh::Place& place) const {
    const int x = std::min(int(place.u * kAcross), kAcross - 1), y = std::min(int(place.v * kAcross), kAcross - 1);
    return nearest_[cut_[place.leaf - mesh_->cells.data()]][y * kAcross + x];
  }

  const PatchSet& scene_;
  const PatchLookup lookup_;
  const DisplayMesh* const mesh_ = nullptr;
  const std::int32_t first_sky_;
  std::vector<std::int32_t> cut_;  ///< [cells]: of leaves that something stands on, their place in `nearest_`.
  std::vector<Nearest> nearest_;
};

/// Which corners of a leaf see places in it, up to four (u,v) of primitive `i`: four bits for each, the first lowest.
/// Corners that are hidden see none.
std::uint32_t seen_corners(const PatchSet& scene, const RayScene& ray_scene, const DisplayMesh& mesh,
                           const DisplayMesh::Cell& leaf, std::int32_t i, std::span<const Vec2f> places);

/// The part of a patch with these (u,v) on its primitive, as a patch of its own.
Patch part_of(const PatchSet& scene, const Patch& patch, float u0, float v0, float u1, float v1);

/// The quarters of a patch, in rows of growing u.
std::array<Patch, 4> quarters(const PatchSet& scene, const Patch& patch);

/// Calls act(element, part) for the elements of one patch's leaves as patches of their own, with the patch's colours;
/// corners are of no size.
void for_each_leaf(const PatchSet& scene, const DisplayMesh& mesh, std::size_t patch,
                   const std::function<void(std::int32_t, const Patch&)>& act);

/// All elements of leaves as patches of their own. Shape: [mesh.elements].
std::vector<Patch> leaf_patches(const PatchSet& scene, const DisplayMesh& mesh);

}  // namespace patchlight
