#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/driver/commands.h"
#include "pipeline/files/energy_file.h"
#include "pipeline/files/file_kind.h"
#include "pipeline/files/h5_store.h"
#include "pipeline/files/image_file.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/files/transport_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

/// A file as named columns.
using Columns = std::map<std::string, H5Reader::Values>;

Columns h5_columns(const std::string& file, const char* format, int version) {
  const H5Reader reader(file, format, version);
  Columns columns;
  for (const auto& name : reader.datasets())
    // Where a scene came from is not in it, nor what a solution believes of itself.
    if (!name.starts_with("/sources/") && name != "/deviation") columns[name] = reader.values(name);
  return columns;
}

H5Reader::Values frame_values(const Image& image, const auto& values) {
  H5Reader::Values column{fmt::format("{} x {}", image.width, image.height), {}, {}};
  for (const auto& value : values)
    if constexpr (requires { value.z; })
      column.numbers.insert(column.numbers.end(), {value.x, value.y, value.z});
    else
      column.numbers.push_back(value);
  return column;
}

Columns frame_columns(const std::string& file) {
  const Image image = read_exr_layers(file);
  Columns columns{{"R, G, B", frame_values(image, image.pixels)}};
  for (const ImageLayer& layer : image.layers)
    std::visit([&](const auto& values) { columns[layer.name + "." + layer.channels] = frame_values(image, values); },
               layer.values);
  return columns;
}

Columns read_columns(const std::string& file, FileKind kind) {
  if (kind == FileKind::patches) return h5_columns(file, kPatchFormat, kPatchVersion);
  if (kind == FileKind::transport) return h5_columns(file, kTransportFormat, kTransportVersion);
  if (kind == FileKind::energy) return h5_columns(file, kEnergyFormat, kEnergyVersion);
  return frame_columns(file);
}

bool texts_equal(const std::string& name, const std::vector<std::string>& a, const std::vector<std::string>& b) {
  if (a == b) return true;
  const auto at = std::mismatch(a.begin(), a.end(), b.begin());
  fmt::print("{:<40}differs: `{}` against `{}` at value {}\n", name, *at.first, *at.second, at.first - a.begin());
  return false;
}

/// NaN differs from numbers alone.
double distance(double a, double b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
  const double d = std::abs(a - b);
  return std::isnan(d) ? INFINITY : d;
}

/// Prints a line on one column. Returns whether the difference is allowed.
bool compare(const DiffCommand& command, const std::string& name, const H5Reader::Values& in_a,
             const H5Reader::Values& in_b) {
  const std::vector<double>&a = in_a.numbers, &b = in_b.numbers;
  if (in_a.shape != in_b.shape || a.size() != b.size()) {
    fmt::print("{:<40}differs: {} values against {}\n", name, in_a.shape, in_b.shape);
    return false;
  }
  if (!in_a.texts.empty()) return texts_equal(name, in_a.texts, in_b.texts);
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
  const double tolerance = command.tolerance.value_or(command.max ? INFINITY : 0.0);
  const bool allowed = rms <= tolerance && (!command.max || peak <= *command.max);
  fmt::print("{:<40}{}: {} of {} values, relative RMS {:.3g}, largest {:.3g} at value {}\n", name,
             allowed ? "within tolerance" : "differs", unequal, a.size(), rms, peak, where);
  return allowed;
}

}  // namespace

int compare_files(const DiffCommand& command) {
  const FileKind kind = kind_of(command.a);
  if (kind == FileKind::scene || kind != kind_of(command.b))
    throw Error(ExitCode::bad_data, "not two files of one kind that Patchlight writes", command.a + ", " + command.b,
                "name two patches.h5, two transport.h5, two energy.h5 or two EXR frames");
  const Columns a = read_columns(command.a, kind), b = read_columns(command.b, kind);
  bool same = true;
  for (const auto& [name, values] : a) {
    const auto other = b.find(name);
    if (other == b.end()) {
      fmt::print("{:<40}differs: only in {}\n", name, command.a);
      same = false;
    } else {
      same = compare(command, name, values, other->second) && same;
    }
  }
  for (const auto& [name, values] : b) {
    if (a.contains(name)) continue;
    fmt::print("{:<40}differs: only in {}\n", name, command.b);
    same = false;
  }
  if (same) fmt::print("no difference beyond the tolerance\n");
  return same ? 0 : 1;
}

}  // namespace patchlight
