#pragma once
#include <filesystem>
#include <vector>

namespace patchlight {

/// Files of an output folder that stages made, but for those kept of earlier settings: patches.h5, transport.h5, its
/// shards and energy.h5 in HDF5 of ours, frames and relit frames with a key of ours in their EXR and the PNG beside it,
/// claims of frames and temporary files. Others with such names are not listed.
std::vector<std::filesystem::path> own_stage_files(const std::filesystem::path& output);

/// Pictures in a `preview` folder by the names that `patchlight preview` gives.
std::vector<std::filesystem::path> own_previews(const std::filesystem::path& folder);

/// Whether a file is a page that `patchlight report` wrote.
bool is_own_report(const std::filesystem::path& file);

/// Whether a file is a `bench.json` that `patchlight bench` wrote.
bool is_own_bench(const std::filesystem::path& file);

/// How many files stand in a folder and its folders.
std::size_t count_files(const std::filesystem::path& folder);

}  // namespace patchlight
