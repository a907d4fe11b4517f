#include "solver/transport/transport_shards.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"
#include "solver/display/display_solution.h"
#include "solver/progress/solve_parts.h"
#include "solver/transport/memory_need.h"
#include "solver/transport/transport_builder.h"

namespace patchlight {

namespace {

template <class Values>
void append(Values& values, const Values& more) {
  values.insert(values.end(), more.begin(), more.end());
}

/// Appends the sky columns of the next shard to those of `rows`, which has its rows already.
void append_sky(TransportRows& rows, const TransportRows& more) {
  if (rows.sky_starts.empty() && more.sky_starts.empty()) return;
  const std::size_t before = rows.starts.size() - more.starts.size();
  rows.sky_starts.resize(before + 1, rows.sky_columns.size());
  rows.sky_weights.resize(before, 0.0f);
  for (std::size_t k = 1; k < more.sky_starts.size(); ++k)
    rows.sky_starts.push_back(rows.sky_columns.size() + more.sky_starts[k]);
  append(rows.sky_weights, more.sky_weights);
  append(rows.sky_columns, more.sky_columns);
  rows.sky_starts.resize(rows.starts.size(), rows.sky_columns.size());
  rows.sky_weights.resize(rows.starts.size() - 1, 0.0f);
}

/// Appends the rows of the next shard.
void append_rows(TransportRows& rows, const TransportRows& more) {
  const auto first_row = std::int32_t(rows.rows());
  const std::uint64_t start = rows.starts.back();
  for (std::size_t k = 1; k < more.starts.size(); ++k) rows.starts.push_back(start + more.starts[k]);
  append(rows.columns, more.columns);
  append(rows.hit_weights, more.hit_weights);
  for (TransportRows::Mirrored m : more.mirrored) {
    m.row += first_row;
    rows.mirrored.push_back(m);
  }
  append_sky(rows, more);
  if (rows.visible_fractions.empty() && more.visible_fractions.empty()) return;
  rows.visible_fractions.resize(2 * std::size_t(first_row), 1.0f);
  append(rows.visible_fractions, more.visible_fractions);
  rows.visible_fractions.resize(2 * std::size_t(rows.rows()), 1.0f);
}

/// No rows yet, with capacity for `count` rows of as many rays as those of `example`.
TransportRows reserved_rows(const TransportRows& example, std::int64_t count) {
  TransportRows rows;
  rows.rays = example.rays;
  rows.starts.reserve(2 * std::size_t(count) + 1);
  rows.starts.push_back(0);
  rows.columns.reserve(std::size_t(count) * std::size_t(example.rays));  // unused pages are never committed
  return rows;
}

/// Reads and checks a shard. `merged`: the shards before it.
TransportShard read_shard(const Job& job, const PatchSet& scene, Shard shard, const Transport& merged) {
  const std::filesystem::path file = transport_shard_file(job, shard);
  const std::string command = fmt::format("run patchlight-solve --shard {}/{}", shard.index, shard.count);
  std::error_code fault;
  if (!std::filesystem::exists(file, fault))
    throw Error(ExitCode::missing_input, "a shard of transport.h5 is missing", file.string(), command);
  const auto refuse = [&](const std::string& problem) {
    throw Error(ExitCode::bad_data, "this shard of transport.h5 " + problem, file.string(), command + " again");
  };
  const DisplayMesh* mesh = merged.display ? &merged.display->mesh : nullptr;
  TransportShard result = read_transport_shard(file, std::int64_t(scene.patches.size()), scene.sky_cells(), mesh);
  if (result.key != transport_shard_key(job, scene, shard)) refuse("was cast for another scene or other settings");
  const auto is_complete = [&](const TransportRows& rows, std::size_t all) {
    return rows.rays > 0 && rows.rows() == std::int64_t(shard.last(all) - shard.first(all));
  };
  const bool starts_display = job.solve.display && shard.index == 1;
  if (!is_complete(result.rows, scene.patches.size()) || (shard.index > 1 && result.rows.rays != merged.rays) ||
      result.mesh.has_value() != starts_display || result.display_rows.has_value() != job.solve.display)
    refuse("does not have the expected rows");
  if (job.solve.display && !is_complete(*result.display_rows, std::size_t((mesh ? mesh : &*result.mesh)->gathered)))
    refuse("does not have the expected rows of the display solution");
  return result;
}

}  // namespace

TransportShard cast_transport_shard(const PatchSet& scene, const SolveConfig& config, Shard shard, Progress& progress) {
  check_memory(scene, config, shard.count);
  const RayScene ray_scene(scene);
  TransportShard result;
  begin_part(SolvePart::rows, config, progress);
  result.cast = cast_rows(scene, ray_scene, config, config.rays, result.rows, progress, shard);
  if (!config.display) return result;
  begin_part(SolvePart::display_rows, config, progress);
  Transport::Display display;
  std::int64_t mesh_rays = 0;
  const int rays = display_rays(std::max(config.rays, result.rows.rays));
  result.cast += cast_display(scene, ray_scene, config, rays, display, mesh_rays, progress, shard);
  result.display_rows = std::move(display.rows);
  if (shard.index > 1) return result;
  result.mesh = std::move(display.mesh);
  result.cast += mesh_rays;
  return result;
}

Transport merge_transport_shards(const Job& job, const PatchSet& scene, int count, std::int64_t& cast,
                                 Progress& progress) {
  Transport transport;
  const auto patches = std::int64_t(scene.patches.size());
  for (int k = 1; k <= count; ++k) {
    TransportShard shard = read_shard(job, scene, {k, count}, transport);
    if (k == 1) static_cast<TransportRows&>(transport) = reserved_rows(shard.rows, patches);
    append_rows(transport, shard.rows);
    if (shard.mesh) {
      const std::int32_t vertices = shard.mesh->gathered;
      transport.display = {std::move(*shard.mesh), reserved_rows(*shard.display_rows, vertices), {}};
    }
    if (shard.display_rows) append_rows(transport.display->rows, *shard.display_rows);
    cast += shard.cast;
    progress.update(double(k) / count, "shards of transport.h5");
  }
  transport.key = transport_key(scene.geometry_key, job.solve);
  transport.sky = scene.sky_cells();
  transport.changed = true;
  return transport;
}

}  // namespace patchlight
