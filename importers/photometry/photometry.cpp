#include "importers/photometry/photometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "importers/photometry/photometric_table.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr std::size_t kMaxFileSize = 16 << 20;
constexpr double kSameAngle = 1e-6;  // degrees

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

bool has_tilt_line(std::string_view text) {
  PhotometricText lines(text, "");
  while (!lines.at_end())
    if (lower_case(lines.line("").substr(0, 5)) == "tilt=") return true;
  return false;
}

/// Columns by angle.
using Columns = std::map<double, std::size_t>;

void add_column(double angle, std::size_t column, Columns& columns) {
  const auto next = columns.lower_bound(angle - kSameAngle);
  if (next == columns.end() || next->first > angle + kSameAngle) columns.emplace(angle, column);
}

/// The half-planes from 0 to 360 degrees, and the column of the table that each is; the last is there before the first,
/// or the first after the last, so that angles between them are.
Columns all_half_planes(const PhotometricTable& table) {
  Columns columns;
  if (table.symmetry == LateralSymmetry::rotational) {
    columns.emplace(0.0, 0);
    return columns;
  }
  const auto add = [&](double angle, std::size_t k) {
    const double turned = angle - 360 * std::floor(angle / 360);
    add_column(turned, k, columns);
  };
  const bool about_c0 = table.symmetry == LateralSymmetry::about_c0 || table.symmetry == LateralSymmetry::quadrants;
  const bool about_c90 = table.symmetry == LateralSymmetry::about_c90 || table.symmetry == LateralSymmetry::quadrants;
  for (std::size_t k = 0; k < table.horizontal.size(); ++k) {
    const double angle = table.horizontal[k];
    add(angle, k);
    if (about_c0) add(-angle, k);
    if (about_c90) add(180 - angle, k);
    if (about_c0 && about_c90) add(180 + angle, k);
  }
  const auto first = *columns.begin(), last = *columns.rbegin();
  if (first.first > kSameAngle) columns.emplace(last.first - 360, last.second);
  columns.emplace(first.first + 360, first.second);
  return columns;
}

/// Angles of types A and B from -90 to 90 degrees: as they are, or mirrored if they begin at 0.
Columns with_negative(const std::vector<double>& angles) {
  Columns columns;
  for (std::size_t k = 0; k < angles.size(); ++k) {
    add_column(angles[k], k, columns);
    if (angles.front() >= 0) add_column(-angles[k], k, columns);
  }
  return columns;
}

}  // namespace

Photometry expanded(const PhotometricTable& table) {
  const bool is_c = table.system == LightDistribution::System::c;
  const Columns horizontal = is_c ? all_half_planes(table) : with_negative(table.horizontal);
  Columns vertical;
  for (std::size_t k = 0; k < table.vertical.size() && is_c; ++k) vertical.emplace(table.vertical[k], k);
  if (!is_c) vertical = with_negative(table.vertical);
  Photometry result;
  result.candela = *std::max_element(table.candela.begin(), table.candela.end());
  LightDistribution& all = result.distribution;
  all.system = table.system;
  for (const auto& [angle, row] : vertical) all.vertical.push_back(angle);
  for (const auto& [angle, column] : horizontal) {
    all.horizontal.push_back(angle);
    for (const auto& [other, row] : vertical) {
      const double value = table.candela[column * table.vertical.size() + row];
      all.intensity.push_back(result.candela > 0 ? static_cast<float>(value / result.candela) : 0.0f);
    }
  }
  return result;
}

int read_count(PhotometricText& text, const std::string& what, int most) {
  return text.whole(text.number(what), what, 1, most);
}

std::vector<double> read_angles(PhotometricText& text, int count, const std::string& what, double low, double high) {
  std::vector<double> angles;
  for (int k = 0; k < count; ++k) {
    const double angle = text.number(what);
    if (!(angle >= low && angle <= high))
      text.refuse(fmt::format("{} of {} degrees is out of the range of {} to {}", what, angle, low, high));
    if (!angles.empty() && angle <= angles.back())
      text.refuse(fmt::format("{} of {} degrees follows one of {}; angles must grow", what, angle, angles.back()));
    angles.push_back(angle);
  }
  return angles;
}

std::vector<double> read_intensities(PhotometricText& text, std::size_t count, double factor) {
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) {
    const double value = factor * text.number("a luminous intensity");
    if (!(value >= 0 && value <= kMaxIntensity))
      text.refuse(fmt::format("a luminous intensity is {} cd; it must be from 0 to {:g}", value, kMaxIntensity));
    values.push_back(value);
  }
  return values;
}

double Photometry::tilt_factor(double degrees) const {
  if (tilt.empty()) return 1.0;
  if (degrees <= tilt.front().first) return tilt.front().second;
  for (std::size_t k = 1; k < tilt.size(); ++k) {
    const auto& [low, before] = tilt[k - 1];
    const auto& [high, after] = tilt[k];
    if (degrees < high) return before + (after - before) * (degrees - low) / (high - low);
  }
  return tilt.back().second;
}

Photometry read_photometry(std::string_view content, const std::string& name, const ReadTiltFile& read_tilt_file) {
  if (content.size() > kMaxFileSize)
    throw Error(ExitCode::over_limit, "a photometric file of more than 16 MiB", name, "is it a photometric file?");
  PhotometricText text(content, name);
  return lower_case(name).ends_with(".ldt") && !has_tilt_line(content) ? read_eulumdat(text)
                                                                       : read_lm63(text, read_tilt_file);
}

}  // namespace patchlight
