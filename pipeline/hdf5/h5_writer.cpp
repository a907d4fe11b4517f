#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "pipeline/hdf5/h5_handle.h"
#include "pipeline/hdf5/h5_layout.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace {

H5Handle text_type(std::size_t size) {
  H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, size);
  if (size != H5T_VARIABLE) H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

}  // namespace

struct H5Writer::State {
  explicit State(const std::filesystem::path& target) : file_name(target) {}

  TemporaryFile file_name;
  H5Handle file;
  std::map<std::string, std::string> attributes;
  std::map<std::string, std::string> hashes;

  template <class T>
  T check(T status, const std::string& what) const {
    if (status < 0)
      throw Error(ExitCode::io_error, "cannot write " + what, file_name.target().string(), "check the free disk space");
    return status;
  }

  void write_scalar(hid_t object, const std::string& name, hid_t type, const void* value) const {
    H5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    H5Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    check(attribute.valid() ? H5Awrite(attribute, type, value) : -1, "attribute " + name);
  }

  /// Variable-length text, which readers in other languages return as text instead of bytes.
  void write_text(const std::string& name, const std::string& value) const {
    const H5Handle type = text_type(H5T_VARIABLE);
    const char* text = value.c_str();
    write_scalar(file, name, type, &text);
  }

  void write_hash(hid_t object, const std::string& hash) const {
    write_scalar(object, kH5HashAttribute, text_type(hash.size()), hash.data());
  }

  void append_trailer() const {
    const std::string trailer = std::string(kH5TrailerWord) + hash_file(file_name.path());
    std::ofstream stream(file_name.path(), std::ios::binary | std::ios::app);
    stream << trailer << std::flush;
    check(stream ? 0 : -1, "the file");
  }

  void write(const std::string& name, hid_t type, const void* data, const std::vector<hsize_t>& shape, bool compress) {
    const std::size_t row_bytes = H5Tget_size(type) * std::size_t(h5_row_length(shape));
    H5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links, 1);
    H5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Handle space(H5Screate_simple(int(shape.size()), shape.data(), nullptr), H5Sclose);
    if (shape[0] > 0) {
      std::vector<hsize_t> chunk = shape;
      chunk[0] = h5_chunk_rows(row_bytes, shape[0]);
      H5Pset_chunk(creation, int(chunk.size()), chunk.data());
      if (compress) H5Pset_deflate(creation, 1);
    }
    H5Handle dataset(H5Dcreate2(file, name.c_str(), type, space, links, creation, H5P_DEFAULT), H5Dclose);
    check(dataset.valid() ? 0 : -1, name);
    if (shape[0] > 0) check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), name);
    const std::string hash = hash_bytes(data, row_bytes * shape[0]);
    write_hash(dataset, hash);
    hashes[name] = hash;
  }
};

H5Writer::H5Writer(const std::filesystem::path& file) : state_(std::make_unique<State>(file)) {
  H5dont_atexit();  // the library's clean-up at exit crashes after a failed write
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
  state_->file = H5Handle(H5Fcreate(state_->file_name.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  if (!state_->file.valid())
    throw Error(ExitCode::cannot_create, "cannot create the file", file.string(), "check that its folder is writable");
}

H5Writer::~H5Writer() = default;

void H5Writer::attribute(const std::string& name, const std::string& value) {
  state_->write_text(name, value);
  state_->attributes[name] = value;
}

void H5Writer::attribute(const std::string& name, std::int64_t value) {
  state_->write_scalar(state_->file, name, H5T_NATIVE_INT64, &value);
  state_->attributes[name] = h5_attribute_text(value);
}

void H5Writer::attribute(const std::string& name, double value) {
  state_->write_scalar(state_->file, name, H5T_NATIVE_DOUBLE, &value);
  state_->attributes[name] = h5_attribute_text(value);
}

template <class T>
void H5Writer::dataset(const std::string& name, std::span<const T> values, int columns, int planes) {
  const std::vector<hsize_t> shape = h5_shape(values.size() / h5_values_per_row(columns, planes), columns, planes);
  state_->write(name, h5_native_type<T>(), values.data(), shape, false);
}

template void H5Writer::dataset(const std::string&, std::span<const double>, int, int);
template void H5Writer::dataset(const std::string&, std::span<const float>, int, int);
template void H5Writer::dataset(const std::string&, std::span<const std::int32_t>, int, int);
template void H5Writer::dataset(const std::string&, std::span<const std::int64_t>, int, int);

void H5Writer::strings(const std::string& name, const std::vector<std::string>& values) {
  std::size_t width = 1;
  for (const auto& value : values) width = std::max(width, std::min(value.size(), kH5MaxString));
  std::string packed(width * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i)
    std::memcpy(packed.data() + i * width, values[i].data(), std::min(values[i].size(), width));
  state_->write(name, text_type(width), packed.data(), {values.size()}, true);
}

std::string H5Writer::key_of(const std::vector<std::string>& prefixes) const {
  KeyHasher hasher;
  for (const auto& [name, hash] : state_->hashes)
    for (const auto& prefix : prefixes)
      if (name.starts_with(prefix)) hasher.add(name).add(hash);
  return hasher.hex();
}

void H5Writer::commit() {
  state_->write_text(kH5DigestAttribute, h5_digest(state_->attributes, state_->hashes));
  state_->check(H5Fflush(state_->file, H5F_SCOPE_GLOBAL), "the file");
  state_->check(state_->file.reset() ? 0 : -1, "the file");
  state_->append_trailer();
  state_->file_name.commit();
}

}  // namespace patchlight
