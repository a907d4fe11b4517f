#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/model/transport.h"

namespace patchlight {

constexpr const char* kTransportFormat = "patchlight-transport";
constexpr int kTransportVersion = 3;

/// Writes transport.h5. Throws: Error (cannot_create, io_error).
void write_transport(const std::filesystem::path& file, const Transport& transport);

/// Reads transport.h5 and checks every index against its number of patches.
/// Throws: Error (missing_input, bad_data).
Transport read_transport(const std::filesystem::path& file);

/// As above; nothing if the file has another key.
std::optional<Transport> read_transport(const std::filesystem::path& file, const std::string& key);

/// Key of a transport.h5. Checks the file's hash. Throws: Error (missing_input, bad_data).
std::string read_transport_key(const std::filesystem::path& file);

}  // namespace patchlight
