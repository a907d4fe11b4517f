#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "pipeline/hdf5/h5_handle.h"
#include "pipeline/hdf5/h5_layout.h"
#include "pipeline/hdf5/h5_reader_state.h"
#include "pipeline/hdf5/h5_store.h"

namespace patchlight {

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
  state_->check_type(dataset, name, h5_native_type<T>());
  const hsize_t count = state_->check_shape(dataset, name, rows, columns, planes, false);
  std::vector<T> values(count * h5_values_per_row(columns, planes));
  state_->read(dataset, name, h5_native_type<T>(), values.data(), values.size() * sizeof(T));
  return values;
}

template std::vector<double> H5Reader::dataset(const std::string&, std::int64_t, int, int) const;
template std::vector<float> H5Reader::dataset(const std::string&, std::int64_t, int, int) const;
template std::vector<std::int32_t> H5Reader::dataset(const std::string&, std::int64_t, int, int) const;
template std::vector<std::int64_t> H5Reader::dataset(const std::string&, std::int64_t, int, int) const;

std::int64_t H5Reader::rows(const std::string& name, int columns, int planes) const {
  return std::int64_t(state_->check_shape(state_->open(name), name, -1, columns, planes, false));
}

template <class T>
void H5Reader::blocks(const std::string& name, std::int64_t rows, int columns, int planes,
                      const std::function<void(std::size_t, std::span<const T>)>& act) const {
  if (!state_->intact) return act(0, dataset<T>(name, rows, columns, planes));  // whole, for its hash
  const H5Handle dataset = state_->open(name);
  state_->check_type(dataset, name, h5_native_type<T>());
  const hsize_t count = state_->check_shape(dataset, name, rows, columns, planes, false);
  if (count == 0) return;
  const std::size_t width = h5_values_per_row(columns, planes);
  const hsize_t step = h5_chunk_rows(width * sizeof(T), count);
  std::vector<T> values(step * width);
  for (hsize_t first = 0; first < count; first += step) {
    const hsize_t end = std::min(first + step, count);
    state_->read_rows(dataset, name, h5_native_type<T>(), values.data(), first, end);
    act(first, std::span(values).first((end - first) * width));
  }
}

template void H5Reader::blocks(const std::string&, std::int64_t, int, int,
                               const std::function<void(std::size_t, std::span<const double>)>&) const;
template void H5Reader::blocks(const std::string&, std::int64_t, int, int,
                               const std::function<void(std::size_t, std::span<const float>)>&) const;
template void H5Reader::blocks(const std::string&, std::int64_t, int, int,
                               const std::function<void(std::size_t, std::span<const std::int32_t>)>&) const;

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
    constexpr hsize_t kMaxWidth = 1 << 20;
    for (std::size_t i = 1; i < shape.size(); ++i)
      if (shape[i] == 0 || shape[i] > kMaxWidth) refuse("wrong shape", name);
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
