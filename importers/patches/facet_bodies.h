#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Which facets meet: the quads and triangles of meshes, by the positions of their corners. Regions and spheres have no
/// corners in common with others.
class FacetBodies {
 public:
  explicit FacetBodies(const std::vector<Primitive>& primitives);

  /// The body of a primitive: all facets that are connected through edges have the same number.
  std::int32_t body(std::int32_t i) const { return body_[i]; }
  /// Diagonal of the box about a body, m, and its number of primitives; both sides of one count once.
  double extent(std::int32_t body) const { return extents_[body]; }
  std::int32_t size(std::int32_t body) const { return sizes_[body]; }

  /// Places of a primitive's corners: equal numbers at equal positions. A triangle repeats its last.
  const std::array<std::int32_t, 4>& places(std::int32_t i) const { return places_[i]; }
  /// The primitives that have a corner at a place.
  std::span<const std::int32_t> at(std::int32_t place) const {
    return std::span(around_).subspan(starts_[place], starts_[place + 1] - starts_[place]);
  }

 private:
  void find_places(const std::vector<Primitive>& primitives);
  void find_bodies(const std::vector<Primitive>& primitives);

  std::vector<std::array<std::int32_t, 4>> places_;  ///< [primitives]; -1 without corners.
  std::vector<std::size_t> starts_;                  ///< [places + 1] Into `around_`.
  std::vector<std::int32_t> around_;
  std::vector<std::int32_t> body_;  ///< [primitives]
  std::vector<double> extents_;     ///< [bodies]
  std::vector<std::int32_t> sizes_;
};

}  // namespace patchlight
