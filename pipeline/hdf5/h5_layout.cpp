#include "pipeline/hdf5/h5_layout.h"

#include <fmt/format.h>

#include "pipeline/system/content_hash.h"

namespace patchlight {

std::string h5_attribute_text(std::int64_t value) {
  return fmt::format("{}", value);
}

std::string h5_attribute_text(double value) {
  return fmt::format("{:a}", value);
}

std::string h5_digest(const std::map<std::string, std::string>& attributes,
                      const std::map<std::string, std::string>& hashes) {
  KeyHasher hasher;
  for (const auto& [name, value] : attributes) hasher.add(name).add(value);
  for (const auto& [name, hash] : hashes) hasher.add(name).add(hash);
  return hasher.hex();
}

}  // namespace patchlight
