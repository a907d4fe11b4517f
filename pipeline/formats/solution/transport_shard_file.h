#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/job/shard.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"

namespace patchlight {

constexpr const char* kTransportShardFormat = "patchlight-transport-shard";
constexpr int kTransportShardVersion = 1;

/// Path of a shard of a job's transport.h5, such as transport.3-of-8.h5 in the same folder.
std::filesystem::path transport_shard_file(const Job& job, Shard shard);

/// All shard files in a job's output folder, of any count.
std::vector<std::filesystem::path> transport_shard_files(const Job& job);

/// Key of a shard of a job's transport.
std::string transport_shard_key(const Job& job, const PatchSet& scene, Shard shard);

/// Whether a shard file exists, is undamaged and has this key.
bool is_fresh_shard(const std::filesystem::path& file, const std::string& key);

/// Throws: Error (cannot_create, io_error).
void write_transport_shard(const std::filesystem::path& file, const TransportShard& shard);

/// Reads a shard of a transport and checks it. `patches`, `sky`: numbers of patches and of environment cells. `mesh`:
/// the display mesh of its rows; null: the one in the file. Throws: Error (missing_input, bad_data).
TransportShard read_transport_shard(const std::filesystem::path& file, std::int64_t patches, int sky,
                                    const DisplayMesh* mesh);

}  // namespace patchlight
