#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// Writes one HDF5 file under a temporary name; commit() renames it.
///
/// Each dataset carries the XXH3 hash of its bytes as attribute `xxh3`. The root attribute `digest` covers all names,
/// hashes and other root attributes. A hash of the whole file follows the HDF5 data. Throws everywhere: Error
/// (cannot_create, io_error).
class H5Writer {
 public:
  explicit H5Writer(const std::filesystem::path& file);
  ~H5Writer();  ///< Without commit(), no file is left.

  void attribute(const std::string& name, const std::string& value);
  void attribute(const std::string& name, std::int64_t value);
  void attribute(const std::string& name, double value);

  /// `name` is an absolute path; missing groups are created. Shape: [values.size() / columns, columns], or the flat
  /// array for columns = 0; `planes` > 1 makes it [.., planes, columns]. T: double, float, int32_t, int64_t.
  template <class T>
  void dataset(const std::string& name, std::span<const T> values, int columns = 0, int planes = 1);

  /// Fixed-length UTF-8 strings, [values.size()]. Each is truncated to 1,024 bytes.
  void strings(const std::string& name, const std::vector<std::string>& values);

  /// Hash of the datasets written so far whose names begin with one of `prefixes`.
  std::string key_of(const std::vector<std::string>& prefixes) const;

  void commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads a file written by H5Writer and validates everything in it. Throws everywhere: Error (missing_input) if the
/// file does not exist; (bad_data) for anything damaged, missing, or of another type or shape.
class H5Reader {
 public:
  /// Checks the root attributes `format` and `version` and the digest.
  H5Reader(const std::filesystem::path& file, const std::string& format, int version);
  ~H5Reader();

  bool has_attribute(const std::string& name) const;
  std::string text(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  double real(const std::string& name) const;

  /// All values of a dataset of `rows` rows (-1: any number), checked against their hash.
  template <class T>
  std::vector<T> dataset(const std::string& name, std::int64_t rows, int columns = 0, int planes = 1) const;

  /// Number of rows of a dataset of numbers.
  std::int64_t rows(const std::string& name, int columns = 0, int planes = 1) const;

  /// Calls fill(item, row) for each of `items` with its row of a dataset of as many rows, of which it holds a few at a
  /// time.
  template <class T, class Items, class Fill>
  void read_into(const std::string& name, Items& items, int columns, Fill fill, int planes = 1) const {
    const std::size_t width = columns > 0 ? std::size_t(columns) * planes : 1;
    blocks<T>(name, std::int64_t(items.size()), columns, planes, [&](std::size_t first, std::span<const T> values) {
      for (std::size_t k = 0; k < values.size() / width; ++k) fill(items[first + k], values.data() + k * width);
    });
  }

  std::vector<std::string> strings(const std::string& name, std::int64_t rows) const;

  /// Whether a dataset exists.
  bool has(const std::string& name) const;

  /// A dataset of any type and shape, for inspection.
  struct Values {
    std::string shape;  ///< Such as `4 x 3`.
    int row = 1;        ///< Number of values in a row.
    std::vector<double> numbers;
    std::vector<std::string> texts;  ///< Of a dataset of strings; `numbers` is then empty.
  };
  Values values(const std::string& name) const;

  /// Names of all datasets, in order.
  std::vector<std::string> datasets() const;

  /// Names of a group's direct children, in order; empty if there is no such group.
  std::vector<std::string> children(const std::string& group) const;

  /// Throws: Error (bad_data) with the fault and the dataset.
  [[noreturn]] void refuse(const std::string& what, const std::string& dataset) const;

 private:
  /// Calls act(first row, values) for blocks of whole rows of a dataset, in order.
  template <class T>
  void blocks(const std::string& name, std::int64_t rows, int columns, int planes,
              const std::function<void(std::size_t, std::span<const T>)>& act) const;

  friend std::string h5_format(const std::filesystem::path& file);
  struct State;
  std::unique_ptr<State> state_;
};

/// The root attribute `format` of an HDF5 file; empty without one. Throws: Error (bad_data) for an unreadable file.
std::string h5_format(const std::filesystem::path& file);

}  // namespace patchlight
