#include "solver/transport/transport_builder.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "pipeline/job/stage_keys.h"
#include "pipeline/optics/sampling/random.h"
#include "solver/direct/direct_factors.h"
#include "solver/direct/light_samples.h"
#include "solver/direct/mirrored_light.h"
#include "solver/form_factors/harmonic_distance.h"
#include "solver/form_factors/ray_rows.h"
#include "solver/form_factors/sky_rows.h"
#include "solver/form_factors/visible_density.h"
#include "solver/hemicube/hemicube.h"
#include "solver/progress/solve_parts.h"

namespace patchlight {

namespace {

/// Draws two hemicubes for each row, one for each sample set.
void draw_rows(const PatchSet& scene, const SolveConfig& config, const VisibleDensities& densities,
               Transport& transport, Progress& progress) {
  HemicubeFormFactors hemicubes(scene, config.hemicube_resolution, std::uint64_t(config.seed), densities);
  std::vector<Shot> shots;
  for (std::size_t k = 0; k < 2 * scene.patches.size(); ++k) shots.push_back({std::int32_t(k / 2), 0, 1 + k % 2});
  transport.starts.push_back(0);
  for (std::size_t done = 0; done < shots.size();) {
    const std::span<const Shot> rest = std::span(shots).subspan(done);
    const std::span<const Shot> batch = rest.first(hemicubes.batch(rest));
    for (const std::span<const FormFactor> row : hemicubes.rows(batch)) {
      for (const FormFactor& f : row) {
        transport.columns.push_back(f.patch);
        transport.weights.push_back(f.value);
      }
      transport.starts.push_back(transport.columns.size());
    }
    done += batch.size();
    progress.update(double(done) / double(shots.size()), "hemicubes");
  }
}

/// Visible area fractions of patches that see unlit backs. Adds the number of rays to `cast`.
std::vector<float> find_visible_fractions(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed,
                                          std::int64_t& cast) {
  std::vector<float> fractions(2 * scene.patches.size(), 1.0f);
  std::atomic<std::int64_t> rays{0};
  tbb::parallel_for(std::size_t(0), scene.patches.size(), [&](std::size_t i) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    const Patch& patch = scene.patches[i];
    const std::uint64_t random = visible_density_random(seed, std::int32_t(i));
    const RefinementCriterion criterion = refinement_criterion(scene, ray_scene, patch, random);
    rays += criterion.rays;
    if (!criterion.hits_backs) return;
    fractions[2 * i] = fractions[2 * i + 1] = VisibleDensity(scene, ray_scene, patch, random).visible_fraction();
    rays += VisibleDensity::kRays;
  });
  cast += rays;
  return fractions;
}

/// Appends the columns of `more` to the rows of the same patches.
void append_columns(const TransportRows& more, TransportRows& rows) {
  TransportRows sum;
  sum.starts.push_back(0);
  for (std::size_t k = 0; k + 1 < rows.starts.size(); ++k) {
    for (const TransportRows* from : {&std::as_const(rows), &more}) {
      const auto begin = std::ptrdiff_t(from->starts[k]), end = std::ptrdiff_t(from->starts[k + 1]);
      sum.columns.insert(sum.columns.end(), from->columns.begin() + begin, from->columns.begin() + end);
      sum.weights.insert(sum.weights.end(), from->weights.begin() + begin, from->weights.begin() + end);
    }
    sum.starts.push_back(sum.columns.size());
  }
  rows.starts = std::move(sum.starts);
  rows.columns = std::move(sum.columns);
  rows.weights = std::move(sum.weights);
}

std::uint64_t with_number(std::uint64_t id, double x) {
  return hash64(id ^ std::bit_cast<std::uint64_t>(x + 0.0));
}

std::uint64_t distribution_id(const LightDistribution& distribution) {
  std::uint64_t id = hash64(std::uint64_t(distribution.system));
  for (const auto* angles : {&distribution.vertical, &distribution.horizontal}) {
    id = hash64(id ^ angles->size());
    for (const double angle : *angles) id = with_number(id, angle);
  }
  for (const float intensity : distribution.intensity) id = with_number(id, double(intensity));
  return id;
}

/// Identifies each emitter's light by its geometry: see Transport::Emitter::light.
std::vector<std::int64_t> light_ids(const PatchSet& scene, const std::vector<Emitter>& emitters) {
  std::vector<std::uint64_t> distributions;
  for (const LightDistribution& distribution : scene.distributions)
    distributions.push_back(distribution_id(distribution));
  std::vector<std::int64_t> ids;
  for (const Emitter& emitter : emitters) {
    ids.push_back(0);
    if (emitter.light < 0) continue;
    const Light& light = scene.lights[emitter.light];
    std::uint64_t id = hash64(std::uint64_t(light.kind) + 1);
    const auto add = [&](const Vec3d& v) {
      for (int k = 0; k < 3; ++k) id = with_number(id, v[k]);
    };
    add(light.position);
    add(light.direction);
    id = with_number(with_number(id, light.inner), light.outer);
    if (light.radius > 0) id = with_number(id, light.radius);
    if (light.distribution >= 0) {
      add(light.across);
      id = hash64(id ^ distributions[light.distribution]);
    }
    ids.back() = std::max<std::int64_t>(std::int64_t(id >> 1), 1);
  }
  return ids;
}

}  // namespace

std::int64_t cast_rows(const PatchSet& scene, const RayScene& ray_scene, const SolveConfig& config, int rays,
                       TransportRows& rows, Progress& progress, Shard shard) {
  const Elements elements(scene);
  return RayRows(scene, ray_scene, scene.patches, elements, std::uint64_t(config.seed), true)
      .cast(rays, rows, progress, shard);
}

std::int64_t complete_transport(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                                Progress& progress) {
  if (scene.light_groups.empty()) return 0;
  const std::string key = transport_key(scene.geometry_key, config);
  const std::vector<Emitter> emitters = explicit_emitters(scene);
  const std::vector<std::int64_t> lights = light_ids(scene, emitters);
  const auto is_same = [&](const Transport::Emitter& sampled, const Emitter& emitter) {
    return sampled.first_patch == emitter.first_patch && sampled.patches == emitter.patches &&
           sampled.light == lights[std::size_t(&emitter - emitters.data())];
  };
  const bool hemicubes = config.form_factors == "hemicube";
  const bool same_rows =
      transport.key == key && transport.sky == scene.sky_cells() && (hemicubes || transport.rays >= rays);
  const std::vector<Emitter> further = further_emitters(scene);
  const std::int64_t further_id = emitters_id(further);
  const auto has_lights = [&] {
    return transport.lights_id == further_id && (further_id == 0 || !transport.lights.starts.empty());
  };
  if (same_rows && has_lights() &&
      std::equal(transport.emitters.begin(), transport.emitters.end(), emitters.begin(), emitters.end(), is_same))
    return 0;

  const std::uint64_t seed = std::uint64_t(config.seed);
  const RayScene ray_scene(scene);
  const PatchLookup lookup(scene);
  std::int64_t cast = 0;
  if (!same_rows) {
    begin_part(SolvePart::rows, config, progress);
    transport = {};
    if (hemicubes) {
      transport.visible_fractions = find_visible_fractions(scene, ray_scene, seed, cast);
      draw_rows(scene, config, {scene, ray_scene, transport.visible_fractions, seed}, transport, progress);
      if (scene.environment) append_columns(sky_rows(scene, ray_scene, rays, seed, cast, progress), transport);
    } else {
      cast += cast_rows(scene, ray_scene, config, rays, transport, progress);
    }
    transport.key = key;
    transport.sky = scene.sky_cells();
  }
  begin_part(SolvePart::direct_light, config, progress);
  const VisibleDensities densities(scene, ray_scene, transport.visible_fractions, seed);
  const Lattices lattices(scene, lookup);
  const DirectFactors direct(scene, ray_scene, scene.patches, grid_neighbours(scene, lookup, lattices), seed,
                             densities);
  if (!has_lights()) {
    transport.lights =
        LightSampler(scene, ray_scene, further, seed).sample(scene.patches, densities, light_rays(rays), cast);
    if (transport.display) transport.display->lights = {};
    transport.lights_id = further_id;
  }
  std::vector<Transport::Emitter> sampled;
  const MirroredLight mirrored(scene, ray_scene, direct, seed);
  for (const Emitter& emitter : emitters) {
    const auto at =
        std::find_if(transport.emitters.begin(), transport.emitters.end(),
                     [&](const Transport::Emitter& e) { return is_same(e, emitter) && !e.factors.empty(); });
    if (at != transport.emitters.end()) {
      sampled.push_back(std::move(*at));
    } else {
      Transport::Emitter& added = sampled.emplace_back(direct.sample(emitter, emitters.size(), rays, cast));
      added.light = lights[std::size_t(&emitter - emitters.data())];
      if (!hemicubes)
        added.mirrored = mirrored.sample(emitter, emitters.size(), rays, transport.visible_fractions, cast);
    }
    progress.update(double(sampled.size()) / double(emitters.size()), "direct light");
  }
  transport.emitters = std::move(sampled);
  transport.changed = true;
  return cast;
}

}  // namespace patchlight
