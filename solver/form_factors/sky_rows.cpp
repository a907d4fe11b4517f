#include "solver/form_factors/sky_rows.h"

#include "solver/form_factors/ray_rows.h"

namespace patchlight {

TransportRows sky_rows(const PatchSet& scene, const RayScene& ray_scene, int rays, std::uint64_t seed,
                       std::int64_t& cast, Progress& progress) {
  const Elements elements(scene);
  TransportRows all, sky;
  cast += RayRows(scene, ray_scene, scene.patches, elements, seed, true).cast(rays, all, progress);
  sky.starts.push_back(0);
  for (std::size_t k = 0; k + 1 < all.starts.size(); ++k) {
    for (std::uint64_t at = all.starts[k]; at < all.starts[k + 1]; ++at) {
      if (std::size_t(all.columns[at]) < scene.patches.size()) continue;
      sky.columns.push_back(all.columns[at]);
      sky.weights.push_back(all.hit_weights[k]);
    }
    if (!all.sky_starts.empty())
      for (std::uint64_t at = all.sky_starts[k]; at < all.sky_starts[k + 1]; ++at) {
        sky.columns.push_back(all.sky_columns[at]);
        sky.weights.push_back(all.sky_weights[k]);
      }
    sky.starts.push_back(sky.columns.size());
  }
  return sky;
}

}  // namespace patchlight
