#pragma once
#include <filesystem>
#include <vector>

namespace patchlight {

/// Files that stages wrote into an output folder, without the cache: patches.h5, transport.h5, its shards and energy.h5
/// with a format attribute of Patchlight; frames and relit frames with a Patchlight key in their EXR, and the PNG
/// beside it; claims of frames and temporary files. Other files with such names are not listed.
std::vector<std::filesystem::path> own_stage_files(const std::filesystem::path& output);

/// Pictures in a `preview` folder with names that `patchlight preview` gives.
std::vector<std::filesystem::path> own_previews(const std::filesystem::path& folder);

/// Whether a file is a page that `patchlight report` wrote.
bool is_own_report(const std::filesystem::path& file);

/// Whether a file is a `bench.json` that `patchlight bench` wrote.
bool is_own_bench(const std::filesystem::path& file);

/// Number of files in a folder and its subfolders.
std::size_t count_files(const std::filesystem::path& folder);

}  // namespace patchlight
