#pragma once
#include <filesystem>

#include "pipeline/model/energy_field.h"

namespace patchlight {

constexpr const char* kEnergyFormat = "patchlight-energy";
constexpr int kEnergyVersion = 2;

/// Writes energy.h5.
/// Throws: Error (cannot_create, io_error).
void write_energy(const std::filesystem::path& file, const PatchSet& scene, const EnergyField& energy);

/// Reads energy.h5 and checks that it belongs to `scene`.
/// Throws: Error (missing_input, bad_data).
EnergyField read_energy(const std::filesystem::path& file, const PatchSet& scene);

/// Reads energy.h5 of any scene, with its light groups in the order of their names.
/// Throws: Error (missing_input, bad_data).
EnergyField read_energy(const std::filesystem::path& file);

}  // namespace patchlight
