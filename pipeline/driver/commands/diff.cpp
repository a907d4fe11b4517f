#include "pipeline/driver/commands/diff.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "pipeline/formats/file_kind.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/formats/solution/transport_file.h"
#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/image/image_file.h"
#include "pipeline/model/error.h"
#include "pipeline/system/standard_streams.h"

namespace patchlight {

namespace {

/// A dataset or layer.
struct Column {
  H5Reader::Values values;
  int width = 0;          ///< Of a frame, pixels; 0: a dataset of rows.
  std::string letters{};  ///< Channel names of a frame.

  /// The place of value `i`, for display.
  std::string place(std::size_t i) const {
    const std::size_t each = std::size_t(values.row), row = i / each, k = i % each;
    if (width > 0)
      return fmt::format("pixel ({}, {}), {}", row % std::size_t(width), row / std::size_t(width), letters[k]);
    return each == 1 ? fmt::format("row {}", row) : fmt::format("row {}, value {}", row, k);
  }
};

/// A file as named columns.
using Columns = std::map<std::string, Column>;

Columns h5_columns(const std::string& file, const char* format, int version) {
  const H5Reader reader(file, format, version);
  Columns columns;
  for (const auto& name : reader.datasets())
    // Provenance and error estimates are not compared.
    if (!name.starts_with("/sources/") && name != "/deviation") columns[name] = {reader.values(name)};
  return columns;
}

Column frame_column(const Image& image, const std::string& letters, const auto& values) {
  Column column{{fmt::format("{} x {}", image.width, image.height), int(letters.size()), {}, {}}, image.width, letters};
  for (const auto& value : values)
    if constexpr (requires { value.z; })
      column.values.numbers.insert(column.values.numbers.end(), {value.x, value.y, value.z});
    else
      column.values.numbers.push_back(value);
  return column;
}

Columns frame_columns(const std::string& file) {
  const Image image = read_exr_layers(file);
  Columns columns{{"R, G, B", frame_column(image, "RGB", image.pixels)}};
  for (const ImageLayer& layer : image.layers)
    std::visit(
        [&](const auto& values) {
          columns[layer.name + "." + layer.channels] = frame_column(image, layer.channels, values);
        },
        layer.values);
  return columns;
}

Columns read_columns(const std::string& file, FileKind kind) {
  if (kind == FileKind::patches) return h5_columns(file, kPatchFormat, kPatchVersion);
  if (kind == FileKind::transport) return h5_columns(file, kTransportFormat, kTransportVersion);
  if (kind == FileKind::transport_shard) return h5_columns(file, kTransportShardFormat, kTransportShardVersion);
  if (kind == FileKind::energy) return h5_columns(file, kEnergyFormat, kEnergyVersion);
  return frame_columns(file);
}

bool texts_equal(const std::string& name, const std::vector<std::string>& a, const std::vector<std::string>& b) {
  if (a == b) return true;
  const auto at = std::mismatch(a.begin(), a.end(), b.begin());
  print(fmt::format("{:<40}differs: row {}: expected `{}`, found `{}`\n", name, at.first - a.begin(), *at.first,
                    *at.second));
  return false;
}

/// Limits of an option by column name: `0.1` for all, `/groups/*=0.1` for some; the last match counts.
class Limits {
 public:
  Limits(const std::string& option, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const std::size_t at = text.rfind('=');
      const std::string number = at == std::string::npos ? text : text.substr(at + 1);
      char* end = nullptr;
      const double limit = std::strtod(number.c_str(), &end);
      if (number.empty() || *end != '\0' || !(limit >= 0))
        throw Error(ExitCode::usage, "not a limit", option + " " + text, "give a number, or NAME=NUMBER, from 0 up");
      limits_.emplace_back(at == std::string::npos ? "*" : text.substr(0, at), limit);
    }
  }

  std::optional<double> of(const std::string& name) const {
    for (auto limit = limits_.rbegin(); limit != limits_.rend(); ++limit)
      if (fnmatch(limit->first.c_str(), name.c_str(), 0) == 0) return limit->second;
    return std::nullopt;
  }

 private:
  std::vector<std::pair<std::string, double>> limits_;  ///< By glob.
};

/// NaN equals NaN and differs from every number.
double distance(double a, double b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
  const double d = std::abs(a - b);
  return std::isnan(d) ? INFINITY : d;
}

/// Prints the line of one column. Returns whether the difference is allowed; without a limit none is.
bool compare(const std::string& name, const Column& in_a, const Column& in_b, std::optional<double> tolerance,
             std::optional<double> max) {
  const std::vector<double>&a = in_a.values.numbers, &b = in_b.values.numbers;
  if (in_a.values.shape != in_b.values.shape || a.size() != b.size()) {
    print(fmt::format("{:<40}differs: expected {} values, found {}\n", name, in_a.values.shape, in_b.values.shape));
    return false;
  }
  if (!in_a.values.texts.empty()) return texts_equal(name, in_a.values.texts, in_b.values.texts);
  double square = 0, difference = 0, largest = 0, largest_difference = 0;
  std::size_t unequal = 0, where = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = distance(a[i], b[i]);
    unequal += d != 0;
    difference += d * d;
    if (std::isfinite(a[i])) {
      square += a[i] * a[i];
      largest = std::max(largest, std::abs(a[i]));
    }
    if (d > largest_difference) where = i;
    largest_difference = std::max(largest_difference, d);
  }
  if (unequal == 0) return true;
  const double rms = square > 0 ? std::sqrt(difference / square) : INFINITY;
  const double peak = largest > 0 ? largest_difference / largest : INFINITY;
  const bool allowed = rms <= tolerance.value_or(max ? INFINITY : 0.0) && peak <= max.value_or(INFINITY);
  print(fmt::format(
      "{:<40}{}: {} of {} values, relative RMS {:.3g}, largest {:.3g} at {}: expected {:.6g}, found {:.6g}\n", name,
      allowed ? "within tolerance" : "differs", unequal, a.size(), rms, peak, in_a.place(where), a[where], b[where]));
  return allowed;
}

}  // namespace

int compare_files(const DiffCommand& command) {
  const Limits tolerance("--tolerance", command.tolerance), max("--max", command.max);
  const FileKind kind = kind_of(command.a);
  if (kind == FileKind::scene || kind != kind_of(command.b))
    throw Error(ExitCode::bad_data, "not two files of one kind that Patchlight writes", command.a + ", " + command.b,
                "name two patches.h5, two transport.h5, two energy.h5 or two EXR frames");
  const Columns a = read_columns(command.a, kind), b = read_columns(command.b, kind);
  bool same = true;
  for (const auto& [name, column] : a) {
    const auto other = b.find(name);
    if (other == b.end()) {
      print(fmt::format("{:<40}differs: only in {}\n", name, command.a));
      same = false;
    } else {
      same = compare(name, column, other->second, tolerance.of(name), max.of(name)) && same;
    }
  }
  for (const auto& [name, column] : b) {
    if (a.contains(name)) continue;
    print(fmt::format("{:<40}differs: only in {}\n", name, command.b));
    same = false;
  }
  if (same) print("no difference beyond the tolerance\n");
  return same ? 0 : 1;
}

}  // namespace patchlight
