#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "pipeline/hdf5/h5_handle.h"
#include "pipeline/hdf5/h5_layout.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace {

// A chunk that we write holds a mebibyte or one row; more asks for memory that no file of ours needs.
constexpr hsize_t kMaxChunkBytes = hsize_t(1) << 24;

H5Handle open_type(hid_t attribute) {
  return {H5Aget_type(attribute), H5Tclose};
}

/// Whether the file ends in a hash of what stands before. Throws: Error (io_error).
bool ends_in_its_hash(const std::filesystem::path& file) {
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

struct H5Reader::State {
  std::filesystem::path path;
  bool whole = false;  ///< Checked before the library reads what it trusts.
  H5Handle file;
  std::map<std::string, std::string> attributes;
  std::map<std::string, std::string> hashes;

  explicit State(const std::filesystem::path& name) : path(name) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    if (std::error_code fault; !std::filesystem::exists(path, fault))
      throw Error(ExitCode::missing_input, "missing file", path.string(), "run the stage that writes it first");
    whole = ends_in_its_hash(path);
    file = H5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file.valid()) refuse("not a readable HDF5 file", "");
    read_attributes();
  }

  [[noreturn]] void refuse(const std::string& what, const std::string& where) const {
    throw Error(ExitCode::bad_data, what, path.string() + (where.empty() ? "" : ", " + where),
                "it is damaged or from another version; run the stage that writes it again");
  }

  /// Texts of the root attributes as the digest takes them; unknown types count as damage.
  void read_attributes() {
    const auto visit = [](hid_t location, const char* name, const H5A_info_t*, void* data) -> herr_t {
      auto& self = *static_cast<State*>(data);
      H5Handle attribute(H5Aopen(location, name, H5P_DEFAULT), H5Aclose);
      if (!attribute.valid()) return -1;
      const H5Handle type = open_type(attribute);
      H5Handle space(H5Aget_space(attribute), H5Sclose);
      if (H5Sget_simple_extent_npoints(space) != 1) return -1;
      if (H5Tget_class(type) == H5T_STRING) {
        const bool variable = H5Tis_variable_str(type) > 0;
        if (variable && !self.whole) return -1;
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

  void read_hashes() {
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

  const std::string& text(const std::string& name) const {
    const auto found = attributes.find(name);
    if (found == attributes.end()) refuse("missing attribute", name);
    return found->second;
  }

  H5Handle open(const std::string& name) const {
    H5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access, 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);  // all is read once: straight to where it goes
    H5Handle dataset(H5Dopen2(file, name.c_str(), access), H5Dclose);
    if (!dataset.valid()) refuse("missing dataset", name);
    return dataset;
  }

  /// Checks the shape against what is asked for and what the file really holds; returns the number of rows.
  hsize_t check_shape(hid_t dataset, const std::string& name, std::int64_t rows, int columns, int planes,
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
    const hsize_t ratio = compressed ? 1100 : 1;  // deflate cannot do better
    if (shape[0] > stored * ratio / (item * row_length)) refuse("truncated", name);
    return shape[0];
  }

  void read(hid_t dataset, const std::string& name, hid_t type, void* data, std::size_t bytes) const {
    if (bytes > 0 && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) refuse("unreadable data", name);
    if (whole) return;
    const auto found = hashes.find(name);
    if (found == hashes.end() || found->second != hash_bytes(data, bytes)) refuse("damaged data", name);
  }
};

H5Reader::H5Reader(const std::filesystem::path& file, const std::string& format, int version)
    : state_(std::make_unique<State>(file)) {
  State& state = *state_;
  if (state.text("format") != format) state.refuse("not a " + format + " file but " + state.text("format"), "format");
  if (integer("version") != version) state.refuse("version " + state.text("version") + " of the format", "version");
  state.read_hashes();
  std::map<std::string, std::string> others = state.attributes;
  others.erase(kH5DigestAttribute);
  if (h5_digest(others, state.hashes) != state.text(kH5DigestAttribute)) state.refuse("damaged file", "digest");
}

H5Reader::~H5Reader() = default;

bool H5Reader::has_attribute(const std::string& name) const {
  return state_->attributes.contains(name);
}

std::string H5Reader::text(const std::string& name) const {
  return state_->text(name);
}

std::int64_t H5Reader::integer(const std::string& name) const {
  try {
    return std::stoll(state_->text(name));
  } catch (const std::logic_error&) {
    state_->refuse("not an integer", name);
  }
}

double H5Reader::real(const std::string& name) const {
  try {
    return std::stod(state_->text(name));
  } catch (const std::logic_error&) {
    state_->refuse("not a number", name);
  }
}

template <class T>
std::vector<T> H5Reader::dataset(const std::string& name, std::int64_t rows, int columns, int planes) const {
  const H5Handle dataset = state_->open(name);
  H5Handle type(H5Dget_type(dataset), H5Tclose);
  if (H5Tequal(type, h5_native_type<T>()) <= 0) state_->refuse("unexpected type", name);
  const hsize_t count = state_->check_shape(dataset, name, rows, columns, planes, false);
  std::vector<T> values(count * h5_values_per_row(columns, planes));
  state_->read(dataset, name, h5_native_type<T>(), values.data(), values.size() * sizeof(T));
  return values;
}

template std::vector<double> H5Reader::dataset(const std::string&, std::int64_t, int, int) const;
template std::vector<float> H5Reader::dataset(const std::string&, std::int64_t, int, int) const;
template std::vector<std::int32_t> H5Reader::dataset(const std::string&, std::int64_t, int, int) const;
template std::vector<std::int64_t> H5Reader::dataset(const std::string&, std::int64_t, int, int) const;

std::vector<std::string> H5Reader::strings(const std::string& name, std::int64_t rows) const {
  const H5Handle dataset = state_->open(name);
  H5Handle type(H5Dget_type(dataset), H5Tclose);
  const std::size_t width = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 || width == 0 || width > kH5MaxString)
    state_->refuse("unexpected type", name);
  const hsize_t count = state_->check_shape(dataset, name, rows, 0, 1, true);
  std::string packed(width * count, '\0');
  state_->read(dataset, name, type, packed.data(), packed.size());
  std::vector<std::string> values(count);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const char* begin = packed.data() + i * width;
    values[i].assign(begin, strnlen(begin, width));
  }
  return values;
}

bool H5Reader::has(const std::string& name) const {
  return state_->hashes.contains(name);
}

H5Reader::Values H5Reader::values(const std::string& name) const {
  std::vector<hsize_t> shape;
  hid_t kind = -1;
  {
    const H5Handle dataset = state_->open(name);
    H5Handle type(H5Dget_type(dataset), H5Tclose);
    H5Handle space(H5Dget_space(dataset), H5Sclose);
    const int dimensions = H5Sget_simple_extent_ndims(space);
    if (dimensions < 1 || dimensions > 3) refuse("wrong number of dimensions", name);
    shape.resize(std::size_t(dimensions));
    H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    for (const hid_t known : {H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT, H5T_NATIVE_INT32, H5T_NATIVE_INT64})
      if (H5Tequal(type, known) > 0) kind = known;
  }
  Values result;
  result.shape = fmt::format("{}", fmt::join(shape, " x "));
  const auto read = [&]<class T>() {
    constexpr hsize_t kWidest = 1 << 20;
    for (std::size_t i = 1; i < shape.size(); ++i)
      if (shape[i] == 0 || shape[i] > kWidest) refuse("wrong shape", name);
    const int columns = shape.size() > 1 ? int(shape.back()) : 0, planes = shape.size() > 2 ? int(shape[1]) : 1;
    const std::vector<T> all = dataset<T>(name, -1, columns, planes);
    result.row = int(h5_values_per_row(columns, planes));
    result.numbers.assign(all.begin(), all.end());
  };
  if (kind == H5T_NATIVE_DOUBLE)
    read.operator()<double>();
  else if (kind == H5T_NATIVE_FLOAT)
    read.operator()<float>();
  else if (kind == H5T_NATIVE_INT32)
    read.operator()<std::int32_t>();
  else if (kind == H5T_NATIVE_INT64)
    read.operator()<std::int64_t>();
  else
    result.texts = strings(name, -1);
  return result;
}

std::vector<std::string> H5Reader::datasets() const {
  std::vector<std::string> names;
  for (const auto& [name, hash] : state_->hashes) names.push_back(name);
  return names;
}

std::vector<std::string> H5Reader::children(const std::string& group) const {
  std::vector<std::string> names;
  for (const auto& [name, hash] : state_->hashes) {
    if (!name.starts_with(group + "/")) continue;
    const std::size_t begin = group.size() + 1;
    const std::string child = name.substr(begin, name.find('/', begin) - begin);
    if (names.empty() || names.back() != child) names.push_back(child);
  }
  return names;
}

void H5Reader::refuse(const std::string& what, const std::string& dataset) const {
  state_->refuse(what, dataset);
}

std::string h5_format(const std::filesystem::path& file) {
  const std::map<std::string, std::string> attributes = H5Reader::State(file).attributes;
  const auto found = attributes.find("format");
  return found == attributes.end() ? "" : found->second;
}

}  // namespace patchlight
