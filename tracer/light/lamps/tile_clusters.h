#pragma once
#include <array>
#include <span>
#include <vector>

#include "pipeline/optics/sampling/random.h"
#include "tracer/light/lamps/shading_cluster.h"

namespace patchlight {

/// Pixels of an image from (x0,y0) on.
struct TileWindow {
  int x0, y0, width, height;

  int pixels() const { return width * height; }
  /// Unique number of a pixel in the image: its row in the upper, its column in the lower 32 bits.
  std::uint64_t pixel_id(std::uint32_t pixel) const {
    return std::uint64_t(y0 + int(pixel) / width) << 32 | std::uint64_t(x0 + int(pixel) % width);
  }
};

/// Shading clusters of a tile, with the clusters of the same surface in the pixels around each.
class TileClusters {
 public:
  explicit TileClusters(const TileWindow& window) : window_(window) {}
  TileClusters(const TileWindow& window, std::vector<ShadingPoint> points);

  /// Those of the 3 x 3 pixels around a cluster, row by row, itself included; -1: none.
  using Neighbours = std::array<std::int32_t, 9>;

  const std::vector<ShadingCluster>& all() const { return clusters_; }
  std::size_t size() const { return clusters_.size(); }
  const ShadingCluster& operator[](std::size_t s) const { return clusters_[s]; }
  const std::vector<Neighbours>& neighbours() const { return neighbours_; }

  /// The cluster of a surface at a pixel with a similar normal; -1: none.
  std::int32_t at(std::uint32_t pixel, std::int32_t surface, const Vec3f& normal) const;
  std::span<const ShadingPoint> points(std::uint32_t pixel) const;

  /// Calls act(cluster) for all clusters of a pixel and the pixels around it.
  template <class Act>
  void for_each_around(std::uint32_t pixel, Act act) const {
    const int x = int(pixel) % window_.width, y = int(pixel) / window_.width;
    const int left = std::max(0, x - 1), right = std::min(window_.width - 1, x + 1);
    for (int v = std::max(0, y - 1); v <= std::min(window_.height - 1, y + 1); ++v)
      for (std::uint32_t s = first_[v * window_.width + left]; s < first_[v * window_.width + right + 1]; ++s) act(s);
  }

 private:
  TileWindow window_;
  std::vector<ShadingPoint> points_;
  std::vector<ShadingCluster> clusters_;  ///< By growing pixel.
  std::vector<std::uint32_t> first_;      ///< [pixels + 1] Of each pixel's clusters.
  std::vector<Neighbours> neighbours_;    ///< [clusters].
};

}  // namespace patchlight
