#pragma once
#include <optional>
#include <span>

#include "pipeline/optics/lights/visible_cells.h"

namespace patchlight {

/// Directions in which a receiver may see the environment, as through a window: those around known ones. Directions are
/// points of the unit square: the arguments of cosine_direction about the receiver's normal, the second of which turns.
class SkyGuide {
 public:
  /// `known`: some directions, at least one.
  explicit SkyGuide(std::span<const Vec2f> known);

  /// The guide's part of the unit square: its form factor. In (0,1].
  float area() const { return size_.x * size_.y * sampler_->area(); }

  bool contains(const Vec2f& at) const;

  /// Maps uniform points of the unit square to uniform points of the guide.
  Vec2f point(const Vec2f& at) const;

 private:
  Vec2f low_, size_;  ///< Corner and size of the rectangle that the cells divide, which may extend over a whole turn.
  VisibleCells cells_;
  std::optional<CellSampler> sampler_;  ///< Of the cells; set by the constructor.
};

/// The direction `at` about the unit vector `from` as a point of the unit square about `to`; its first coordinate is
/// above 1 for a direction below the horizon.
Vec2f turned_direction(const Vec2f& at, const Vec3f& from, const Vec3f& to);

}  // namespace patchlight
