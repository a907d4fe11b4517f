#include <fmt/format.h>

#include <string>

#include "importers/photometry/photometric_table.h"

namespace patchlight {
namespace {

constexpr int kMaxLampSets = 20, kLinesOfLampSet = 6;
constexpr int kDirectRatios = 10;
constexpr double kMaxFlux = 1e12;  // lm

double read_factor(PhotometricText& text, const std::string& what, double most) {
  const double value = text.line_number(what);
  if (!(value >= 0 && value <= most))
    text.refuse(fmt::format("{} is {}; it must be from 0 to {:g}", what, value, most));
  return value;
}

void skip_lines(PhotometricText& text, int count, const std::string& what) {
  for (int k = 0; k < count; ++k) text.line(what);
}

int whole_line(PhotometricText& text, const std::string& what, int low, int high) {
  return text.whole(text.line_number(what), what, low, high);
}

/// Reads all angles, one a line, from 0 on.
std::vector<double> read_angle_lines(PhotometricText& text, int count, const std::string& what, double high) {
  std::vector<double> angles;
  for (int k = 0; k < count; ++k) {
    const double angle = text.line_number(what);
    if (!(angle >= 0 && angle <= high))
      text.refuse(fmt::format("{} of {} degrees is out of the range of 0 to {}", what, angle, high));
    if (!angles.empty() && angle <= angles.back())
      text.refuse(fmt::format("{} of {} degrees follows one of {}; angles must grow", what, angle, angles.back()));
    angles.push_back(angle);
  }
  return angles;
}

/// The first half-plane whose intensities the file has, and their number: the next ones, from the last to the first on.
struct ListedPlanes {
  LateralSymmetry symmetry;
  int first, count;
};

ListedPlanes listed_planes(PhotometricText& text, int symmetry, int planes) {
  const int divisor = symmetry == 2 ? 2 : symmetry >= 3 ? 4 : 1;
  if (planes % divisor != 0)
    text.refuse(fmt::format("the number of C-planes is {}; with symmetry {} it must be a multiple of {}", planes,
                            symmetry, divisor));
  switch (symmetry) {
    case 0:
      return {LateralSymmetry::none, 0, planes};
    case 1:
      return {LateralSymmetry::rotational, 0, 1};
    case 2:
      return {LateralSymmetry::about_c0, 0, planes / 2 + 1};
    case 3:
      return {LateralSymmetry::about_c90, 3 * planes / 4, planes / 2 + 1};
    default:
      return {LateralSymmetry::quadrants, 0, planes / 4 + 1};
  }
}

}  // namespace

Photometry read_eulumdat(PhotometricText& text) {
  text.line("the company");
  whole_line(text, "the type of light source", 0, 3);
  const int symmetry = whole_line(text, "the symmetry", 0, 4);
  const int planes = whole_line(text, "the number of C-planes", 1, kMaxAngles);
  const ListedPlanes listed = listed_planes(text, symmetry, planes);
  text.line("the distance between C-planes");
  const int vertical = whole_line(text, "the number of intensities in a C-plane", 1, kMaxAngles);
  if (std::size_t(vertical) * std::size_t(planes) > kMaxValues)
    text.refuse(fmt::format("{} x {} luminous intensities are more than {}", vertical, planes, kMaxValues));
  skip_lines(text, 17, "the conversion factor");  // names, sizes and parts of the flux
  double factor = read_factor(text, "the conversion factor", 1e9);
  text.line("the tilt of the luminaire");
  const int sets = whole_line(text, "the number of lamp sets", 1, kMaxLampSets);
  skip_lines(text, 2, "the luminous flux of the lamps");
  factor *= read_factor(text, "the luminous flux of the lamps", kMaxFlux) / 1000;  // values are per 1000 lm
  skip_lines(text, 3 + (sets - 1) * kLinesOfLampSet, "the direct ratios");         // the first set counts
  skip_lines(text, kDirectRatios, "the angles of C-planes");
  const std::vector<double> all = read_angle_lines(text, planes, "the angle of a C-plane", 360);
  PhotometricTable table;
  table.symmetry = listed.symmetry;
  table.vertical = read_angle_lines(text, vertical, "a vertical angle", 180);
  for (int k = 0; k < listed.count; ++k) {
    table.horizontal.push_back(all[std::size_t((listed.first + k) % planes)]);
    for (int i = 0; i < vertical; ++i) {
      const double value = factor * text.line_number("a luminous intensity");
      if (!(value >= 0 && value <= kMaxIntensity))
        text.refuse(fmt::format("a luminous intensity is {} cd; it must be from 0 to {:g}", value, kMaxIntensity));
      table.candela.push_back(value);
    }
  }
  return expanded(table);
}

}  // namespace patchlight
