#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/job/schema/job_schema.h"

namespace patchlight {

// Keys with a single value of some type. `help`: text in the list of keys.

JobKey path_key(const std::string& path, std::filesystem::path& value, const std::string& help);
JobKey number_key(const std::string& path, double& value, double low, double high, const std::string& help);
JobKey integer_key(const std::string& path, int& value, std::int64_t low, std::int64_t high, const std::string& help);
JobKey integer_key(const std::string& path, std::int64_t& value, std::int64_t low, std::int64_t high,
                   const std::string& help);
JobKey flag_key(const std::string& path, bool& value, const std::string& help);
JobKey choice_key(const std::string& path, std::string& value, const std::vector<std::string>& choices,
                  const std::string& help);

/// A size in bytes, as in 500MiB; units are powers of 1024.
JobKey size_key(const std::string& path, std::uint64_t& bytes, const std::string& help);

}  // namespace patchlight
