#pragma once
#include <filesystem>

#include "pipeline/model/energy_field.h"

namespace patchlight {

constexpr const char* kEnergyFormat = "patchlight-energy";

/// Writes energy.h5.
/// Throws: Error (cannot_create, io_error).
void write_energy(const std::filesystem::path& file, const PatchSet& scene, const EnergyField& energy);

/// Reads energy.h5 and checks that it belongs to `scene`.
/// Throws: Error (missing_input, bad_data).
EnergyField read_energy(const std::filesystem::path& file, const PatchSet& scene);

/// Reads energy.h5 whatever scene it belongs to: its own groups, in the order of their names.
/// Throws: Error (missing_input, bad_data).
EnergyField read_energy(const std::filesystem::path& file);

/// The key of the patch file that an energy.h5 was solved from. Throws: Error (missing_input, bad_data).
std::string energy_patches_key(const std::filesystem::path& file);

}  // namespace patchlight
