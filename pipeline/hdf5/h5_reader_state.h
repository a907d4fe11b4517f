#pragma once
// Internal to H5Reader: includes hdf5.h.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "pipeline/hdf5/h5_handle.h"
#include "pipeline/hdf5/h5_store.h"

namespace patchlight {

/// An open HDF5 file, its root attributes, and the hashes of its datasets. Functions throw Error (bad_data) for damaged
/// contents.
struct H5Reader::State {
  std::filesystem::path path;
  bool intact =
      false;  ///< The file ends in its correct hash, so the HDF5 library may read structures without checksums.
  H5Handle file;
  std::map<std::string, std::string> attributes;  ///< Root attributes as text, as the digest uses them.
  std::map<std::string, std::string> hashes;      ///< By name of dataset; empty before read_hashes().

  /// Opens the file and reads its root attributes. Throws: Error (missing_input) if it does not exist; (bad_data).
  explicit State(const std::filesystem::path& name);

  [[noreturn]] void refuse(const std::string& what, const std::string& where) const;
  void read_hashes();
  const std::string& text(const std::string& name) const;
  H5Handle open(const std::string& name) const;

  /// Checks that a dataset's values have this type.
  void check_type(hid_t dataset, const std::string& name, hid_t type) const;

  /// Checks a dataset's shape, chunks and stored size. `rows`: -1 for any number. Returns the number of rows.
  hsize_t check_shape(hid_t dataset, const std::string& name, std::int64_t rows, int columns, int planes,
                      bool compressed) const;

  /// Reads a whole dataset and checks its hash.
  void read(hid_t dataset, const std::string& name, hid_t type, void* data, std::size_t bytes) const;

  /// Reads rows `first` to `end` - 1 of a dataset of an intact file.
  void read_rows(hid_t dataset, const std::string& name, hid_t type, void* data, hsize_t first, hsize_t end) const;

 private:
  void read_attributes();
};

}  // namespace patchlight
