#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/shard.h"
#include "pipeline/model/transport.h"

namespace patchlight {

constexpr const char* kTransportShardFormat = "patchlight-transport-shard";
constexpr int kTransportShardVersion = 1;

/// Where a shard of a job's transport.h5 stands: transport.3-of-8.h5 beside it.
std::filesystem::path transport_shard_file(const Job& job, Shard shard);

/// All shards that stand in a job's output, of whatever number.
std::vector<std::filesystem::path> transport_shard_files(const Job& job);

/// The key that a shard of a job's transport has.
std::string transport_shard_key(const Job& job, const PatchSet& scene, Shard shard);

/// Whether a shard is there, whole and has the key.
bool is_fresh_shard(const std::filesystem::path& file, const std::string& key);

/// Throws: Error (cannot_create, io_error).
void write_transport_shard(const std::filesystem::path& file, const TransportShard& shard);

/// Reads a shard of the transport of `patches` under `sky` cells of the environment and checks that all in it is within
/// bounds. `mesh`: the display mesh that its rows belong to; null: its own. Throws: Error (missing_input, bad_data).
TransportShard read_transport_shard(const std::filesystem::path& file, std::int64_t patches, int sky,
                                    const DisplayMesh* mesh);

}  // namespace patchlight
