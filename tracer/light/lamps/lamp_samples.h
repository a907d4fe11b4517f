#pragma once
#include <algorithm>

#include "pipeline/optics/lights/shadow_rays.h"
#include "tracer/light/lamps/shading_cluster.h"

namespace patchlight {

constexpr double kFarLamp = 2.0;  ///< Distance in radii of a lamp from which it is sampled by area.

// Numbers of rays to lamps. A lamp's share is its part of a cluster's unoccluded light.

/// Probes to a lamp of this share.
int probe_count(float share);

/// Rays to a partly hidden lamp of this share, in proportion to the standard deviation of its visibility. `samples`: of
/// a pixel, an eighth of the rays to a single lamp that is half hidden.
int ray_count(float share, int samples, const Visibility& visibility);

/// Adds rays to `count` samples of a lamp, distributed over the points of a cluster. `place(i)`: sample i in the unit
/// square.
template <class Place>
void sample_lamp(const ExplicitLights::Lamp& lamp, const ShadingCluster& cluster, int count, Place place,
                 ShadowRays& rays, LightSamples& sums) {
  const int points = std::min(int(cluster.points.size()), count);
  for (int k = 0; k < points; ++k) {
    const ShadingPoint& point = cluster.points[std::size_t(k) * cluster.points.size() / std::size_t(points)];
    const DirectLight::View view = lamp.light.view(point.position, point.normal, kFarLamp);
    for (int i = k; i < count; i += points) {
      const Vec2f to = place(i);
      const DirectLight::Sample light = view.sample(to.x, to.y);
      ++sums.count;
      if (light.weight > 0) rays.add(point.position, light, to, sums);
    }
  }
}

/// Probe k of a pixel (x,y) to a lamp, in the unit square. The probes of any 3 x 3 pixels cover the square evenly, and
/// all of a tile's probes finely, so that some pass through a slit. `shift`: of the lamp.
Vec2f probe_place(int x, int y, int k, std::uint64_t shift);

/// Form factor to the visible part of a lamp by samples. `unoccluded`: to all of it; `visibility`: by other samples.
float visible_factor(float unoccluded, const LightSamples& samples, const Visibility& visibility);

}  // namespace patchlight
