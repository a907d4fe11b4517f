#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "pipeline/optics/lights/visible_cells.h"
#include "tracer/light/lamps/tile_clusters.h"

namespace patchlight {

/// Light of one lamp that reaches clusters through slits or holes, which few shadow rays find: most rays go where the
/// rays of neighbouring clusters reached the lamp, as in path guiding, and some anywhere, weighted by the balance
/// heuristic (Veach and Guibas 1995).
class GuidedLight {
 public:
  GuidedLight(const RayScene& ray_scene, const DirectLight& light, const TileClusters& clusters)
      : ray_scene_(ray_scene), light_(light), clusters_(clusters), seen_(clusters.size()), sees_(clusters.size(), 0) {}

  /// Records a sample through which a cluster saw the lamp.
  void add(std::size_t cluster, const Vec2f& at) {
    seen_[cluster].add(at);
    sees_[cluster] = 1;
  }

  /// Form factor to the visible part of the lamp: the part in cells that neighbours saw, and the noisy rest.
  struct Factor {
    double guided = 0.0, rest = 0.0;
    bool found = false;  ///< False: no neighbour sees the lamp; nothing was sampled.
  };

  /// Form factors of the listed clusters, by about `rays` rays each. `seed`: of the lamp in this tile.
  std::vector<Factor> factors(std::span<const std::uint32_t> listed, int rays, std::uint64_t seed);

 private:
  bool is_found(std::size_t cluster) const {
    return std::ranges::any_of(clusters_.neighbours()[cluster], [&](std::int32_t s) { return s >= 0 && sees_[s]; });
  }
  VisibleCells around(std::size_t cluster) const;
  template <class Act>
  void cast(std::size_t cluster, const CellSampler* guide, int count, std::uint64_t seed, Act act) const;

  const RayScene& ray_scene_;
  const DirectLight& light_;
  const TileClusters& clusters_;
  std::vector<VisibleCells> seen_;  ///< [clusters] Where each saw the lamp.
  std::vector<std::uint8_t> sees_;  ///< [clusters] Whether it did.
};

}  // namespace patchlight
