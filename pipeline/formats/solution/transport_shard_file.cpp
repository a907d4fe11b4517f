#include "pipeline/formats/solution/transport_shard_file.h"

#include <fmt/format.h>

#include "pipeline/formats/solution/display_mesh_file.h"
#include "pipeline/formats/solution/transport_rows_file.h"
#include "pipeline/hdf5/provenance_file.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"
#include "pipeline/system/text_scanner.h"

namespace patchlight {

namespace fs = std::filesystem;

namespace {

/// transport.k-of-K.h5
bool is_shard_name(const std::string& name) {
  TextScanner text(name);
  return text.skip("transport.") && !text.take_digits().empty() && text.skip("-of-") && !text.take_digits().empty() &&
         text.skip(".h5") && text.done();
}

}  // namespace

fs::path transport_shard_file(const Job& job, Shard shard) {
  return job.output / fmt::format("transport.{}-of-{}.h5", shard.index, shard.count);
}

std::vector<fs::path> transport_shard_files(const Job& job) {
  std::vector<fs::path> files;
  std::error_code fault;
  for (fs::directory_iterator entry(job.output, fault), end; !fault && entry != end; entry.increment(fault))
    if (is_shard_name(entry->path().filename().string())) files.push_back(entry->path());
  return files;
}

std::string transport_shard_key(const Job& job, const PatchSet& scene, Shard shard) {
  return KeyHasher()
      .add("transport shard")
      .add(transport_key(scene.geometry_key, job.solve))
      .add(job.solve.display)
      .add(shard.index)
      .add(shard.count)
      .hex();
}

bool is_fresh_shard(const fs::path& file, const std::string& key) {
  try {
    return H5Reader(file, kTransportShardFormat, kTransportShardVersion).text("key") == key;
  } catch (const Error&) {
    return false;
  }
}

void write_transport_shard(const fs::path& file, const TransportShard& shard) {
  H5Writer writer(file);
  write_rows(writer, "", shard.rows);
  if (!shard.rows.visible_fractions.empty()) writer.dataset<float>("/exposed", shard.rows.visible_fractions, 2);
  if (shard.display_rows) write_rows(writer, "/display", *shard.display_rows);
  if (shard.mesh) write_display_mesh(writer, *shard.mesh);
  writer.attribute("format", kTransportShardFormat);
  writer.attribute("version", std::int64_t(kTransportShardVersion));
  writer.attribute("key", shard.key);
  write_provenance(writer, shard.made);
  writer.attribute("rays", std::int64_t(shard.rows.rays));
  if (shard.display_rows) writer.attribute("display_rays", std::int64_t(shard.display_rows->rays));
  writer.attribute("rays_cast", shard.cast);
  writer.commit();
}

TransportShard read_transport_shard(const fs::path& file, std::int64_t patches, int sky, const DisplayMesh* mesh) {
  const H5Reader reader(file, kTransportShardFormat, kTransportShardVersion);
  TransportShard shard;
  shard.key = reader.text("key");
  shard.made = read_provenance(reader);
  shard.cast = reader.integer("rays_cast");
  read_rows(reader, "", patches + sky, false, reader.integer("rays"), shard.rows);
  shard.rows.visible_fractions = read_visible_fractions(reader, shard.rows.rows());
  if (reader.has("/display/mesh/roots")) shard.mesh = read_display_mesh(reader, patches);
  if (!reader.has("/display/rows/start")) return shard;
  if (!mesh && shard.mesh) mesh = &*shard.mesh;
  if (!mesh) reader.refuse("rows of a display mesh that the file does not contain", "/display/rows/start");
  read_rows(reader, "/display", patches + mesh->elements() + sky, false, reader.integer("display_rays"),
            shard.display_rows.emplace());
  return shard;
}

}  // namespace patchlight
