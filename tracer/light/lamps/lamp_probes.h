#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/optics/lights/shadow_rays.h"
#include "tracer/light/lamps/tile_clusters.h"

namespace patchlight {

/// What probes from a tile's clusters found of each lamp. The clusters must outlive it.
class LampProbes {
 public:
  explicit LampProbes(const TileClusters& clusters) : clusters_(clusters) {}

  /// Adds the next lamp. `with_tints`: surfaces may let light pass. Shape: probes.size() == clusters.size().
  void add(const std::vector<LightSamples>& probes, bool with_tints);

  /// Visibility of a lamp around a cluster.
  struct Local {
    Visibility samples;
    bool sharp = false;  ///< Some neighbours see all of the lamp, and others none of it.
  };
  /// By the probes of a cluster's neighbours.
  Local around(std::size_t lamp, std::size_t cluster) const;

  /// By all probes from a pixel and its neighbours.
  Visibility around_pixel(std::size_t lamp, std::uint32_t pixel) const;

  /// By a cluster's own probes.
  Visibility of(std::size_t lamp, std::size_t cluster) const;

  /// What surfaces let pass of a lamp's light, by the probes of a cluster and of its neighbours.
  Color tint(std::size_t lamp, std::size_t cluster) const {
    return tints_.empty() ? Color(1.0f) : tints_[lamp * clusters_.size() + cluster];
  }

  /// Number of clusters with a probe that reaches the lamp.
  std::uint32_t reaching(std::size_t lamp) const { return reaching_[lamp]; }

 private:
  struct Counts {
    std::uint8_t visible = 0, hidden = 0, dimmed = 0;
  };

  const TileClusters& clusters_;
  std::vector<Counts> counts_;           ///< [lamps][clusters].
  std::vector<Color> tints_;             ///< [lamps][clusters]; empty: no surface lets light pass.
  std::vector<std::uint32_t> reaching_;  ///< [lamps].
};

}  // namespace patchlight
