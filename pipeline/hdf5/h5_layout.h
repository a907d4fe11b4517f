#pragma once
#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

// The file layout shared by H5Writer and H5Reader.

constexpr const char* kH5HashAttribute = "xxh3";
constexpr const char* kH5DigestAttribute = "digest";
constexpr std::size_t kH5MaxString = 1024;
constexpr std::size_t kH5MaxText = std::size_t(1) << 24;

/// After the HDF5 data, whose end HDF5 itself records, follow this word and a hash of all bytes before it. HDF5 stores
/// variable-length text in a heap without checksums, which its library does not validate; so the hash is checked first.
constexpr std::string_view kH5TrailerWord = "patchlight-xxh3:";
constexpr std::size_t kH5TrailerSize = kH5TrailerWord.size() + 32;

// Shapes are [rows], [rows, columns] or [rows, planes, columns]; columns = 0: flat.

inline std::size_t h5_values_per_row(int columns, int planes) {
  return columns > 0 ? std::size_t(columns) * planes : 1;
}

/// Rows of a chunk: 1 MiB, or one row.
inline hsize_t h5_chunk_rows(std::size_t row_bytes, hsize_t rows) {
  return std::clamp<hsize_t>((hsize_t(1) << 20) / row_bytes, 1, rows);
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

/// Exact text of an attribute's value, for the digest.
std::string h5_attribute_text(std::int64_t value);
std::string h5_attribute_text(double value);

/// Hash of all root attributes and of all datasets' names and hashes.
std::string h5_digest(const std::map<std::string, std::string>& attributes,
                      const std::map<std::string, std::string>& hashes);

}  // namespace patchlight
