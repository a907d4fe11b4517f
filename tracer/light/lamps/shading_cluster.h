#pragma once
#include <array>
#include <span>
#include <vector>

#include "tracer/light/lamps/explicit_lights.h"

namespace patchlight {

/// Shading points of one pixel on one surface, with similar normals.
struct ShadingCluster {
  std::uint32_t pixel = 0;
  std::int32_t surface = 0;
  std::int32_t primitive = 0;  ///< Of the first point.
  std::span<const ShadingPoint> points;
  Vec3d center{0.0};
  Vec3f normal{0.0f};   ///< Mean of the points'.
  bool flat = true;     ///< The points' normals are the same.
  double radius = 0.0;  ///< Around the centre, m.
  Color weight{0.0f};   ///< Sum over the points.
  std::array<Color, 4> weights{Color(0.0f), Color(0.0f), Color(0.0f), Color(0.0f)};  ///< Of the points by SeenBy.
  bool scattered = false;  ///< Some points are seen by a rough metal.

  explicit ShadingCluster(std::span<const ShadingPoint> cluster_points);

  /// Form factor to a whole unoccluded emitter, the mean over the points; of the centre alone if the cluster is small
  /// for its distance from the emitter.
  double form_factor(const DirectLight& light, const Emitter& emitter) const;

  /// Factor of a light where normals are turned to be valid for the viewer: its own shading normal darkens a surface
  /// smoothly towards the terminator (Chiang, Li and Burley, "Taming the Shadow Terminator", SIGGRAPH Talks 2019).
  double terminator(const DirectLight& light) const;
};

/// Sorts points and groups them into clusters, by growing pixel.
std::vector<ShadingCluster> shading_clusters(std::vector<ShadingPoint>& points);

}  // namespace patchlight
