#pragma once
#include <span>
#include <vector>

#include "tracer/light/pixel_light.h"

namespace patchlight {

/// The points of a pixel on one surface, where they face alike.
struct ShadingCluster {
  std::uint32_t pixel = 0;
  std::int32_t surface = 0;
  std::int32_t primitive = 0;  ///< Of the first point.
  std::span<const ShadingPoint> points;
  Vec3d middle{0.0};
  Vec3f normal{0.0f};
  double radius = 0.0;     ///< About the middle, m.
  Color weight{0.0f};      ///< Sum of the points'.
  Color mirrored{0.0f};    ///< The part of it of those that are not seen straight.
  bool scattered = false;  ///< Whether any is seen by way of a rough metal.

  explicit ShadingCluster(std::span<const ShadingPoint> all);

  /// Form factor to a whole lamp, if nothing hid it, in the mean over the points; from the middle alone where the spot
  /// is small for how far it is from the lamp.
  double form_factor(const PixelLight::Lamp& lamp) const;
};

/// Puts points in order and makes them into spots, by growing pixel.
std::vector<ShadingCluster> shading_clusters(std::vector<ShadingPoint>& points);

}  // namespace patchlight
