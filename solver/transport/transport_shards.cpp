#include "solver/transport/transport_shards.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"
#include "solver/display/display_solution.h"
#include "solver/transport/memory_need.h"
#include "solver/transport/transport_builder.h"

namespace patchlight {

namespace {

template <class Values>
void append(Values& to, const Values& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// Appends the rows of the next shard.
void append_rows(TransportRows& to, const TransportRows& more) {
  const auto before = std::int32_t(to.rows());
  const std::uint64_t start = to.starts.back();
  for (std::size_t k = 1; k < more.starts.size(); ++k) to.starts.push_back(start + more.starts[k]);
  append(to.columns, more.columns);
  append(to.hit_weights, more.hit_weights);
  for (TransportRows::Mirrored m : more.mirrored) {
    m.row += before;
    to.mirrored.push_back(m);
  }
  if (to.visible_fractions.empty() && more.visible_fractions.empty()) return;
  to.visible_fractions.resize(2 * std::size_t(before), 1.0f);
  append(to.visible_fractions, more.visible_fractions);
  to.visible_fractions.resize(2 * std::size_t(to.rows()), 1.0f);
}

/// Rows that other shards are appended to.
TransportRows no_rows(const TransportRows& like, std::int64_t rows) {
  TransportRows none;
  none.rays = like.rays;
  none.starts.reserve(2 * std::size_t(rows) + 1);
  none.starts.push_back(0);
  none.columns.reserve(std::size_t(rows) * std::size_t(like.rays));  // what is not needed is never touched
  return none;
}

/// `before`: what the shards before it make.
TransportShard read_shard(const Job& job, const PatchSet& scene, Shard shard, const Transport& before) {
  const std::filesystem::path file = transport_shard_file(job, shard);
  const std::string mend = fmt::format("run patchlight-solve --shard {}/{}", shard.index, shard.count);
  std::error_code fault;
  if (!std::filesystem::exists(file, fault))
    throw Error(ExitCode::missing_input, "a shard of transport.h5 is missing", file.string(), mend);
  const auto refuse = [&](const std::string& what) {
    throw Error(ExitCode::bad_data, "a shard of transport.h5 that " + what, file.string(), mend + " again");
  };
  const DisplayMesh* mesh = before.display ? &before.display->mesh : nullptr;
  TransportShard read = read_transport_shard(file, std::int64_t(scene.patches.size()), scene.sky_cells(), mesh);
  if (read.key != transport_shard_key(job, scene, shard)) refuse("was cast for other settings or another scene");
  const auto is_part = [&](const TransportRows& rows, std::size_t all) {
    return rows.rays > 0 && rows.rows() == std::int64_t(shard.last(all) - shard.first(all));
  };
  const bool starts_display = job.solve.display && shard.index == 1;
  if (!is_part(read.rows, scene.patches.size()) || (shard.index > 1 && read.rows.rays != before.rays) ||
      read.mesh.has_value() != starts_display || read.display_rows.has_value() != job.solve.display)
    refuse("has other rows than it should");
  if (job.solve.display && !is_part(*read.display_rows, std::size_t((mesh ? mesh : &*read.mesh)->gathered)))
    refuse("has other rows of the display solution than it should");
  return read;
}

}  // namespace

TransportShard cast_transport_shard(const PatchSet& scene, const SolveConfig& config, Shard shard, Progress& progress) {
  check_memory(scene, config, shard.count);
  const RayScene ray_scene(scene);
  TransportShard result;
  result.cast = cast_rows(scene, ray_scene, config, config.rays, result.rows, progress, shard);
  if (!config.display) return result;
  Transport::Display display;
  std::int64_t for_mesh = 0;
  const int rays = display_rays(std::max(config.rays, result.rows.rays));
  result.cast += cast_display(scene, ray_scene, config, rays, display, for_mesh, progress, shard);
  result.display_rows = std::move(display.rows);
  if (shard.index > 1) return result;
  result.mesh = std::move(display.mesh);
  result.cast += for_mesh;
  return result;
}

Transport merge_transport_shards(const Job& job, const PatchSet& scene, int count, std::int64_t& cast,
                                 Progress& progress) {
  Transport transport;
  const auto patches = std::int64_t(scene.patches.size());
  for (int k = 1; k <= count; ++k) {
    TransportShard shard = read_shard(job, scene, {k, count}, transport);
    if (k == 1) static_cast<TransportRows&>(transport) = no_rows(shard.rows, patches);
    append_rows(transport, shard.rows);
    if (shard.mesh) {
      const std::int32_t vertices = shard.mesh->gathered;
      transport.display = {std::move(*shard.mesh), no_rows(*shard.display_rows, vertices)};
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
