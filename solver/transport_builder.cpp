#include "solver/transport_builder.h"

#include <algorithm>
#include <cmath>

#include "pipeline/files/key.h"
#include "solver/direct_factors.h"
#include "solver/hemicube.h"
#include "solver/ray_rows.h"
#include "solver/surroundings.h"

namespace patchlight {

namespace {

/// Two hemicubes a row, one for each half.
void draw_rows(const PatchSet& scene, const SolveConfig& config, Transport& transport, Progress& progress) {
  HemicubeFormFactors hemicubes(scene, config.hemicube_resolution, std::uint64_t(config.seed));
  std::vector<Shot> shots;
  for (std::size_t k = 0; k < 2 * scene.patches.size(); ++k) shots.push_back({std::int32_t(k / 2), 0, 1 + k % 2});
  transport.starts.push_back(0);
  for (std::size_t done = 0; done < shots.size();) {
    const std::span<const Shot> rest = std::span(shots).subspan(done);
    const std::span<const Shot> batch = rest.first(hemicubes.batch(rest));
    for (const std::span<const FormFactor> row : hemicubes.rows(batch)) {
      for (const FormFactor& f : row) {
        transport.ends.push_back(f.patch);
        transport.weights.push_back(f.value);
      }
      transport.starts.push_back(transport.ends.size());
    }
    done += batch.size();
    progress.update(double(done) / double(shots.size()), "hemicubes");
  }
}

/// Leaves out of every row those rays that start where it is not exposed: they see nothing.
void leave_hidden_out(const std::vector<float>& exposed, Transport& transport) {
  const auto nowhere = std::int32_t(exposed.size());
  std::vector<double> scale(exposed.size(), 1.0);
  std::uint64_t begin = 0, kept = 0;
  for (std::size_t k = 0; k + 1 < transport.starts.size(); ++k) {
    const std::uint64_t end = transport.starts[k + 1], rays = end - begin;
    auto hidden = std::uint64_t(std::lround((1.0 - double(exposed[k / 2])) * double(rays)));
    const std::uint64_t first = kept;
    for (std::uint64_t at = begin; at < end; ++at) {
      if (hidden > 0 && transport.ends[at] == nowhere)
        --hidden;
      else
        transport.ends[kept++] = transport.ends[at];
    }
    if (kept > first) scale[k / 2] = double(rays) / double(kept - first);
    transport.starts[k + 1] = kept;
    begin = end;
  }
  transport.ends.resize(kept);
  for (auto& m : transport.mirrored) m.weight *= float(scale[m.row]);
}

}  // namespace

std::int64_t complete_transport(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                                Progress& progress) {
  if (scene.light_groups.empty()) return 0;
  const std::string key = transport_key(scene.geometry_key, config);
  std::vector<Emitter> wanted = emitters_apart(scene);
  std::sort(wanted.begin(), wanted.end(),
            [](const Emitter& a, const Emitter& b) { return a.first_patch < b.first_patch; });
  const auto kept = [&](const Emitter& emitter) {
    return std::find_if(transport.emitters.begin(), transport.emitters.end(), [&](const Transport::Emitter& e) {
      return e.first_patch == emitter.first_patch && e.patches == emitter.patches;
    });
  };
  const bool hemicubes = config.form_factors == "hemicube";
  const bool same_rows = transport.key == key && (hemicubes || transport.longest() >= rays);
  if (same_rows && wanted.size() == transport.emitters.size() &&
      std::all_of(wanted.begin(), wanted.end(), [&](const Emitter& e) { return kept(e) != transport.emitters.end(); }))
    return 0;

  const std::uint64_t seed = std::uint64_t(config.seed);
  const RayScene ray_scene(scene);
  const PatchLookup lookup(scene);
  std::int64_t cast = 0;
  const std::vector<float> exposed = exposed_parts(scene, ray_scene, seed, cast);
  if (!same_rows) {
    transport = {};
    if (hemicubes) {
      draw_rows(scene, config, transport, progress);
    } else {
      cast += RayRows(scene, ray_scene, scene.patches, Elements(scene), seed).cast(rays, transport, progress);
      leave_hidden_out(exposed, transport);
    }
    transport.key = key;
  }
  std::vector<Transport::Emitter> emitters;
  const DirectFactors direct(scene, ray_scene, scene.patches, grid_neighbours(scene, lookup), seed);
  for (const Emitter& emitter : wanted) {
    if (const auto at = kept(emitter); at != transport.emitters.end()) {
      emitters.push_back(std::move(*at));
    } else {
      emitters.push_back(direct.sample(emitter, wanted.size(), rays, cast));
      std::vector<float>& factors = emitters.back().factors;
      for (std::size_t k = 0; k < factors.size(); ++k) factors[k] /= exposed[k / 2];
    }
    progress.update(double(emitters.size()) / double(wanted.size()), "direct light");
  }
  transport.emitters = std::move(emitters);
  transport.changed = true;
  return cast;
}

}  // namespace patchlight
