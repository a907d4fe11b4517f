#include "tracer/light/lamps/tile_clusters.h"

#include <utility>

namespace patchlight {

constexpr float kMinCosine = 0.95f;  // between the normals of a cluster and of a point that shares its light

TileClusters::TileClusters(const TileWindow& window, std::vector<ShadingPoint> points)
    : window_(window),
      points_(std::move(points)),
      clusters_(shading_clusters(points_)),
      first_(std::size_t(window.pixels()) + 1, 0),
      neighbours_(clusters_.size()) {
  for (const ShadingCluster& cluster : clusters_) ++first_[cluster.pixel + 1];
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    const int x = int(clusters_[s].pixel) % window_.width, y = int(clusters_[s].pixel) / window_.width;
    for (int k = 0; k < 9; ++k) {
      const int u = x + k % 3 - 1, v = y + k / 3 - 1;
      const bool inside = u >= 0 && v >= 0 && u < window_.width && v < window_.height;
      neighbours_[s][k] =
          inside ? at(std::uint32_t(v * window_.width + u), clusters_[s].surface, clusters_[s].normal) : -1;
    }
  }
}

std::int32_t TileClusters::at(std::uint32_t pixel, std::int32_t surface, const Vec3f& normal) const {
  for (std::uint32_t s = first_[pixel]; s < first_[pixel + 1]; ++s)
    if (clusters_[s].surface == surface && (clusters_[s].normal ^ normal) > kMinCosine) return std::int32_t(s);
  return -1;
}

std::span<const ShadingPoint> TileClusters::points(std::uint32_t pixel) const {
  const std::uint32_t first = first_[pixel], end = first_[pixel + 1];
  if (first == end) return {};
  return {clusters_[first].points.data(), clusters_[end - 1].points.data() + clusters_[end - 1].points.size()};
}

}  // namespace patchlight
