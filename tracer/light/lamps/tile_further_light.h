#pragma once
#include "tracer/light/lamps/further_light.h"
#include "tracer/light/lamps/tile_clusters.h"

namespace patchlight {

/// FurtherLight at the clusters of a tile. A few probes of a cluster and its neighbours tell how many emitters are
/// chosen next: many where shadows are, few where other light outshines them.
class TileFurtherLight {
 public:
  /// `samples`: see TileLight.
  TileFurtherLight(const FurtherLight& light, const TileClusters& clusters, const TileWindow& window, int samples);

  /// Whether some probed clusters around a cluster see all emitters that their probes chose, others none, and these
  /// outshine the cluster's other light: a shadow edge that takes more points.
  bool sharp(std::size_t cluster, float brightness) const;

  /// Light at a probed cluster, whose other light has this `brightness`, W/m2, sum of channels. Shape: [groups], W/m2
  /// at the scene's own strength.
  std::vector<Color> at(std::size_t cluster, float brightness) const;

  /// The same at a cluster of points in a probed pixel. `part`: of the pixel's points.
  std::vector<Color> at(const ShadingCluster& cluster, float part, std::uint64_t seed) const;

 private:
  struct Around {
    Visibility visibility;
    float brightness = 0.0f;  ///< Mean, W/m2, sum of channels.
    float variance = 0.0f;    ///< Relative, of the probes' brightness.
  };
  Around around(std::uint32_t pixel, std::int32_t cluster) const;
  int count(const Around& around, float brightness, float part = 1.0f) const;
  std::vector<Color> result(const FurtherLight::Samples& samples, const Around& around) const;

  void choose();

  const FurtherLight& light_;
  const TileClusters& clusters_;
  const TileWindow& window_;
  const int samples_;
  std::vector<FurtherLight::Choices> choices_;  ///< Of blocks of clusters.
  std::vector<std::uint32_t> block_;            ///< [clusters], into `choices_`.
  std::vector<FurtherLight::Samples> probes_;   ///< [clusters].
};

}  // namespace patchlight
