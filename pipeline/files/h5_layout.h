#pragma once
#include <hdf5.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace patchlight {

// What H5Writer and H5Reader agree on.

constexpr const char* kH5HashAttribute = "xxh3";
constexpr const char* kH5DigestAttribute = "digest";
constexpr std::size_t kH5MaxString = 1024;

inline std::size_t h5_values_per_row(int columns, int planes) {
  return columns > 0 ? std::size_t(columns) * planes : 1;
}

inline std::vector<hsize_t> h5_shape(hsize_t rows, int columns, int planes) {
  std::vector<hsize_t> shape{rows};
  if (planes > 1) shape.push_back(planes);
  if (columns > 0) shape.push_back(columns);
  return shape;
}

inline hsize_t h5_row_length(const std::vector<hsize_t>& shape) {
  hsize_t length = 1;
  for (std::size_t i = 1; i < shape.size(); ++i) length *= shape[i];
  return length;
}

/// The exact text that an attribute's value adds to the digest.
std::string h5_attribute_text(std::int64_t value);
std::string h5_attribute_text(double value);

/// One hash over every root attribute and every dataset's name and hash.
std::string h5_digest(const std::map<std::string, std::string>& attributes,
                      const std::map<std::string, std::string>& hashes);

}  // namespace patchlight
