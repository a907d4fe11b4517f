#pragma once
#include <filesystem>
#include <string>

#include "pipeline/model/patch_set.h"

namespace patchlight {

constexpr const char* kPatchFormat = "patchlight-patches";
constexpr int kPatchVersion = 2;

/// Writes patches.h5 and sets `key` and `frames_key` in `scene`.
/// Throws: Error (cannot_create, io_error).
void write_patches(const std::filesystem::path& file, PatchSet& scene);

/// Reads patches.h5 and checks that indices are in range, numbers finite, and patches in the order of PatchSet.
/// Throws: Error (missing_input, bad_data).
PatchSet read_patches(const std::filesystem::path& file);

}  // namespace patchlight
