#include "pipeline/hdf5/h5_reader_state.h"

#include <algorithm>
#include <cstring>
#include <fstream>

#include "pipeline/hdf5/h5_layout.h"
#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {
namespace {

// H5Writer's chunks have 1 MiB, or one row; larger ones would only waste memory.
constexpr hsize_t kMaxChunkBytes = hsize_t(1) << 24;

H5Handle open_type(hid_t attribute) {
  return {H5Aget_type(attribute), H5Tclose};
}

/// Whether the file ends in the hash of all bytes before it. Throws: Error (io_error).
bool has_correct_trailer(const std::filesystem::path& file) {
  std::error_code fault;
  const std::uintmax_t size =
      std::filesystem::is_regular_file(file, fault) ? std::filesystem::file_size(file, fault) : 0;
  if (fault || size < kH5TrailerSize) return false;
  std::string trailer(kH5TrailerSize, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(std::streamoff(size - kH5TrailerSize));
  if (!stream.read(trailer.data(), std::streamsize(trailer.size())) || !trailer.starts_with(kH5TrailerWord))
    return false;
  return hash_file(file, size - kH5TrailerSize) == trailer.substr(kH5TrailerWord.size());
}

std::string read_variable_text(hid_t attribute, hid_t type) {
  char* text = nullptr;
  if (H5Aread(attribute, type, &text) < 0 || !text) return {};
  const std::string value(text, strnlen(text, kH5MaxText));
  H5free_memory(text);
  return value;
}

std::string read_fixed_text(hid_t attribute, hid_t type) {
  const std::size_t size = H5Tget_size(type);
  if (size > kH5MaxText || H5Aget_storage_size(attribute) != size) return {};
  std::string value(size, '\0');
  if (H5Aread(attribute, type, value.data()) < 0) return {};
  value.resize(std::min(value.size(), value.find('\0')));
  return value;
}

}  // namespace

H5Reader::State::State(const std::filesystem::path& name) : path(name) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  if (std::error_code fault; !std::filesystem::exists(path, fault))
    throw Error(ExitCode::missing_input, "missing file", path.string(), "run the stage that writes it first");
  intact = has_correct_trailer(path);
  file = H5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.valid()) refuse("not a readable HDF5 file", "");
  read_attributes();
}

void H5Reader::State::refuse(const std::string& what, const std::string& where) const {
  throw Error(ExitCode::bad_data, what, path.string() + (where.empty() ? "" : ", " + where),
              "it is damaged or from another version; run the stage that writes it again");
}

void H5Reader::State::read_attributes() {
  const auto visit = [](hid_t location, const char* name, const H5A_info_t*, void* data) -> herr_t {
    auto& self = *static_cast<State*>(data);
    H5Handle attribute(H5Aopen(location, name, H5P_DEFAULT), H5Aclose);
    if (!attribute.valid()) return -1;
    const H5Handle type = open_type(attribute);
    H5Handle space(H5Aget_space(attribute), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != 1) return -1;
    if (H5Tget_class(type) == H5T_STRING) {
      const bool variable = H5Tis_variable_str(type) > 0;
      if (variable && !self.intact) return -1;
      self.attributes[name] = variable ? read_variable_text(attribute, type) : read_fixed_text(attribute, type);
    } else if (H5Tequal(type, H5T_NATIVE_INT64) > 0) {
      std::int64_t value = 0;
      if (H5Aread(attribute, type, &value) < 0) return -1;
      self.attributes[name] = h5_attribute_text(value);
    } else if (H5Tequal(type, H5T_NATIVE_DOUBLE) > 0) {
      double value = 0;
      if (H5Aread(attribute, type, &value) < 0) return -1;
      self.attributes[name] = h5_attribute_text(value);
    } else {
      return -1;
    }
    return 0;
  };
  if (H5Aiterate2(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, this) < 0) refuse("unreadable attributes", "");
}

void H5Reader::State::read_hashes() {
  const auto visit = [](hid_t group, const char* name, const H5L_info_t* link, void* data) -> herr_t {
    auto& self = *static_cast<State*>(data);
    if (link->type != H5L_TYPE_HARD) return -1;
    H5Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
    if (!object.valid()) return -1;
    if (H5Iget_type(object) != H5I_DATASET) return 0;
    H5Handle attribute(H5Aopen(object, kH5HashAttribute, H5P_DEFAULT), H5Aclose);
    if (!attribute.valid()) return -1;
    const H5Handle type = open_type(attribute);
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) return -1;
    self.hashes["/" + std::string(name)] = read_fixed_text(attribute, type);
    return 0;
  };
  if (H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, visit, this) < 0) refuse("unreadable datasets", "");
}

const std::string& H5Reader::State::text(const std::string& name) const {
  const auto found = attributes.find(name);
  if (found == attributes.end()) refuse("missing attribute", name);
  return found->second;
}

H5Handle H5Reader::State::open(const std::string& name) const {
  H5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access, 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);  // each chunk is read once, directly into the result
  H5Handle dataset(H5Dopen2(file, name.c_str(), access), H5Dclose);
  if (!dataset.valid()) refuse("missing dataset", name);
  return dataset;
}

void H5Reader::State::check_type(hid_t dataset, const std::string& name, hid_t type) const {
  H5Handle stored(H5Dget_type(dataset), H5Tclose);
  if (H5Tequal(stored, type) <= 0) refuse("unexpected type", name);
}

hsize_t H5Reader::State::check_shape(hid_t dataset, const std::string& name, std::int64_t rows, int columns, int planes,
                                     bool compressed) const {
  H5Handle space(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> expected = h5_shape(0, columns, planes);
  std::vector<hsize_t> shape(expected.size());
  if (H5Sget_simple_extent_ndims(space) != int(shape.size())) refuse("wrong number of dimensions", name);
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  expected[0] = rows < 0 ? shape[0] : hsize_t(rows);
  if (shape != expected) refuse("wrong shape", name);
  if (shape[0] == 0) return 0;

  H5Handle type(H5Dget_type(dataset), H5Tclose);
  H5Handle creation(H5Dget_create_plist(dataset), H5Pclose);
  std::vector<hsize_t> chunk(shape.size());
  if (H5Pget_layout(creation) != H5D_CHUNKED || H5Pget_chunk(creation, int(chunk.size()), chunk.data()) < 0)
    refuse("unexpected layout", name);
  const hsize_t item = H5Tget_size(type);
  const hsize_t row_length = h5_row_length(shape);
  if (chunk[0] == 0 || h5_row_length(chunk) != row_length || chunk[0] > kMaxChunkBytes / (item * row_length))
    refuse("unexpected chunks", name);
  const hsize_t stored = H5Dget_storage_size(dataset);
  const hsize_t ratio = compressed ? 1100 : 1;  // the greatest compression ratio of deflate
  if (shape[0] > stored * ratio / (item * row_length)) refuse("truncated", name);
  return shape[0];
}

void H5Reader::State::read(hid_t dataset, const std::string& name, hid_t type, void* data, std::size_t bytes) const {
  if (bytes > 0 && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) refuse("unreadable data", name);
  if (intact) return;
  const auto found = hashes.find(name);
  if (found == hashes.end() || found->second != hash_bytes(data, bytes)) refuse("damaged data", name);
}

void H5Reader::State::read_rows(hid_t dataset, const std::string& name, hid_t type, void* data, hsize_t first,
                                hsize_t end) const {
  H5Handle stored(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> count(std::size_t(H5Sget_simple_extent_ndims(stored)));
  H5Sget_simple_extent_dims(stored, count.data(), nullptr);
  std::vector<hsize_t> start(count.size());
  start[0] = first;
  count[0] = end - first;
  H5Sselect_hyperslab(stored, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  H5Handle space(H5Screate_simple(int(count.size()), count.data(), nullptr), H5Sclose);
  if (H5Dread(dataset, type, space, stored, H5P_DEFAULT, data) < 0) refuse("unreadable data", name);
}

}  // namespace patchlight
