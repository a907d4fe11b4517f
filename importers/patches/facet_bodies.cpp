#include "importers/patches/facet_bodies.h"

#include <ImathBox.h>

#include <algorithm>
#include <tuple>

#include "importers/mesh/vertex_welding.h"

namespace patchlight {
namespace {

bool is_facet(const Primitive& p) {
  return p.shape == Primitive::Shape::quad && !p.region;
}

}  // namespace

FacetBodies::FacetBodies(const std::vector<Primitive>& primitives) {
  find_places(primitives);
  find_bodies(primitives);
}

void FacetBodies::find_places(const std::vector<Primitive>& primitives) {
  struct Corner {
    Vec3d position;
    std::int32_t primitive, k;
    auto key() const { return std::tuple(position.x, position.y, position.z); }
  };
  std::vector<Corner> corners;
  for (std::int32_t i = 0; i < std::int32_t(primitives.size()); ++i)
    for (std::int32_t k = 0; k < 4 && is_facet(primitives[i]); ++k) corners.push_back({primitives[i].corners[k], i, k});
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::tuple(a.key(), a.primitive, a.k) < std::tuple(b.key(), b.primitive, b.k);
  });
  places_.assign(primitives.size(), {-1, -1, -1, -1});
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (k == 0 || corners[k].key() != corners[k - 1].key()) starts_.push_back(around_.size());
    places_[corners[k].primitive][corners[k].k] = std::int32_t(starts_.size()) - 1;
    if (around_.size() == starts_.back() || around_.back() != corners[k].primitive)
      around_.push_back(corners[k].primitive);
  }
  starts_.push_back(around_.size());
}

void FacetBodies::find_bodies(const std::vector<Primitive>& primitives) {
  DisjointSets sets(primitives.size());
  for (std::int32_t i = 0; i < std::int32_t(primitives.size()); ++i) {
    if (primitives[i].back >= 0) sets.join(i, primitives[i].back);
    for (int k = 0; k < 4 && places_[i][0] >= 0; ++k) {
      const std::int32_t a = places_[i][k], b = places_[i][(k + 1) % 4];
      for (const std::int32_t other : at(a))
        if (other < i && a != b && std::count(places_[other].begin(), places_[other].end(), b) > 0) sets.join(i, other);
    }
  }
  std::vector<std::int32_t> number(primitives.size(), -1);
  std::vector<Imath::Box3d> boxes;
  for (std::int32_t i = 0; i < std::int32_t(primitives.size()); ++i) {
    std::int32_t& body = number[sets.find(i)];
    if (body < 0) {
      body = std::int32_t(boxes.size());
      boxes.emplace_back();
      sizes_.push_back(0);
    }
    body_.push_back(body);
    if (primitives[i].back < 0 || i < primitives[i].back) ++sizes_[body];
    for (const Vec3d& corner : primitives[i].corners) boxes[body].extendBy(corner);
  }
  for (const Imath::Box3d& box : boxes) extents_.push_back(box.size().length());
}

}  // namespace patchlight
