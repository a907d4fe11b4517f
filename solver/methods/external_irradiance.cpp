#include "solver/methods/external_irradiance.h"

#include "solver/direct/direct_factors.h"
#include "solver/form_factors/sky_rows.h"
#include "solver/linear/irradiance_filter.h"

namespace patchlight {

std::vector<Vec3d> ExternalIrradiance::of_light(const Emitter& emitter, std::int64_t& cast) const {
  const DirectFactors direct(scene_, ray_scene_, scene_.patches, grid_neighbours(scene_, lookup_, lattices_), seed_);
  const Transport::Emitter factors = direct.sample(emitter, scene_.lights.size(), rays_, cast);
  const Vec3d strength(scene_.lights[emitter.light].strength);
  std::vector<Vec3d> irradiance;
  irradiance.reserve(scene_.patches.size());
  for (std::size_t i = 0; i < scene_.patches.size(); ++i)
    irradiance.push_back(
        positive(strength * (Vec3d(factors.received(2 * i)) + Vec3d(factors.received(2 * i + 1))) * 0.5));
  return irradiance;
}

std::vector<Vec3d> ExternalIrradiance::of_environment(std::int64_t& cast, Progress& progress) const {
  const Environment& sky = *scene_.environment;
  const std::size_t n = scene_.patches.size();
  const TransportRows rows = sky_rows(scene_, ray_scene_, rays_, seed_, cast, progress);
  SpectrumField radiosity(n + sky.cells.size()), gathered(n), deviation(n), reflectance;
  for (std::size_t k = 0; k < sky.cells.size(); ++k) radiosity[n + k] = Spectrum(sky.cells[k]) * Spectrum(kPi);
  const FormFactorRows::Field field{&radiosity, {&gathered, &deviation}};
  FormFactorRows(rows).gather({&field, 1}, nullptr, FormFactorRows::Precision::full);
  for (const Patch& patch : scene_.patches) reflectance.emplace_back(patch.reflectance);
  const std::vector<FilterGrid> grids = filter_grids(scene_, lookup_, lattices_);
  gathered = IrradianceFilter(grids, gathered, deviation, reflectance, gathered).apply(gathered);
  std::vector<Vec3d> irradiance;
  irradiance.reserve(n);
  for (const Spectrum& h : gathered) irradiance.push_back(positive(Vec3d(h.c[0], h.c[1], h.c[2])));
  return irradiance;
}

}  // namespace patchlight
