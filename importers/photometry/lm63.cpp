#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <string>

#include "importers/photometry/photometric_table.h"

namespace patchlight {
namespace {

constexpr int kMaxTilts = 1000;
constexpr double kMaxFactor = 1e9;
constexpr double kSameAngle = 1e-3;  // degrees; by which the first and the last angle may be off

std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return upper;
}

bool is_same(double a, double b) {
  return std::abs(a - b) <= kSameAngle;
}

double read_factor(PhotometricText& text, const std::string& what) {
  const double value = text.number(what);
  if (!(value >= 0 && value <= kMaxFactor))
    text.refuse(fmt::format("{} is {}; it must be from 0 to {:g}", what, value, kMaxFactor));
  return value;
}

/// Factors on the light by the luminaire's tilt: as after TILT=INCLUDE, and as in the file of TILT=FILE.
std::vector<std::pair<double, double>> read_tilt(PhotometricText& text) {
  text.whole(text.number("the lamp-to-luminaire geometry"), "the lamp-to-luminaire geometry", 1, 3);
  const int count = read_count(text, "the number of tilt angles", kMaxTilts);
  std::vector<std::pair<double, double>> tilt;
  for (const double angle : read_angles(text, count, "a tilt angle", 0, 180)) tilt.emplace_back(angle, 1.0);
  for (auto& [angle, factor] : tilt) factor = read_factor(text, "a factor of a tilt angle");
  return tilt;
}

/// Takes all lines up to that of TILT=, which it returns in upper and as it is.
std::string_view skip_to_tilt(PhotometricText& text, std::string& first) {
  for (bool is_first = true;; is_first = false) {
    const std::string_view line = text.line("a line TILT=: is it a photometric file (LM-63)?");
    if (is_first) first = upper_case(line.substr(0, 40));
    if (upper_case(line.substr(0, 5)) == "TILT=") return line.substr(5);
  }
}

/// The symmetry of half-planes from `first` to `last` of type C.
LateralSymmetry symmetry_of(PhotometricText& text, const std::vector<double>& angles) {
  const double first = angles.front(), last = angles.back();
  if (angles.size() == 1) return LateralSymmetry::rotational;
  if (is_same(first, 90) && is_same(last, 270)) return LateralSymmetry::about_c90;
  if (is_same(first, 0) && is_same(last, 90)) return LateralSymmetry::quadrants;
  if (is_same(first, 0) && is_same(last, 180)) return LateralSymmetry::about_c0;
  if (is_same(first, 0) && last > 180) return LateralSymmetry::none;
  text.refuse(
      fmt::format("horizontal angles of type C go from {} to {} degrees; required is one angle, 0 to 90, 0 to "
                  "180, 0 to 360, or 90 to 270",
                  first, last));
}

void check_angles_of_others(PhotometricText& text, const std::vector<double>& angles, const std::string& what) {
  const bool begins = is_same(angles.front(), 0) || is_same(angles.front(), -90);
  if (angles.size() == 1 || !begins || !is_same(angles.back(), 90))
    text.refuse(fmt::format("{} angles of types A and B go from {} to {} degrees; required is -90 or 0 to 90", what,
                            angles.front(), angles.back()));
}

}  // namespace

Photometry read_lm63(PhotometricText& text, const ReadTiltFile& read_tilt_file) {
  std::string version;
  const std::string tilt_name(skip_to_tilt(text, version));
  std::vector<std::pair<double, double>> tilt;
  if (upper_case(tilt_name) == "INCLUDE") {
    tilt = read_tilt(text);
  } else if (upper_case(tilt_name) != "NONE") {
    if (tilt_name.empty()) text.refuse("TILT= names no file; required is NONE, INCLUDE or the name of a file");
    const std::string content = read_tilt_file(tilt_name);
    PhotometricText tilt_text(content, tilt_name);
    tilt = read_tilt(tilt_text);
  }
  // The intensities are those of the luminaire, with as many lamps and lumens as it says, or absolute (-1 lumens).
  text.whole(text.number("the number of lamps"), "the number of lamps", 0, 100'000);
  text.number("the lumens of a lamp");
  double factor = read_factor(text, "the multiplier");
  const int vertical = read_count(text, "the number of vertical angles", kMaxAngles);
  const int horizontal = read_count(text, "the number of horizontal angles", kMaxAngles);
  if (std::size_t(vertical) * std::size_t(horizontal) > kMaxValues)
    text.refuse(fmt::format("{} x {} luminous intensities are more than {}", vertical, horizontal, kMaxValues));
  PhotometricTable table;
  table.system =
      LightDistribution::System(text.whole(text.number("the photometric type"), "the photometric type", 1, 3));
  text.whole(text.number("the type of units"), "the type of units", 1, 2);
  for (const char* what : {"the width", "the length", "the height"}) text.number(what);
  factor *= read_factor(text, "the ballast factor");
  // Up to 1995 a factor; then reserved; since 2019 the type of the file.
  const double lamp_factor = read_factor(text, "the ballast-lamp factor");
  if (!version.ends_with("LM-63-2002") && !version.ends_with("LM-63-2019")) factor *= lamp_factor;
  text.number("the watts");
  const bool is_c = table.system == LightDistribution::System::c;
  table.vertical = read_angles(text, vertical, "a vertical angle", is_c ? 0 : -90, is_c ? 180 : 90);
  if (!is_c) check_angles_of_others(text, table.vertical, "vertical");
  table.horizontal = read_angles(text, horizontal, "a horizontal angle", is_c ? 0 : -90, is_c ? 360 : 90);
  if (is_c)
    table.symmetry = symmetry_of(text, table.horizontal);
  else
    check_angles_of_others(text, table.horizontal, "horizontal");
  table.candela = read_intensities(text, std::size_t(vertical) * std::size_t(horizontal), factor);
  Photometry result = expanded(table);
  result.tilt = std::move(tilt);
  return result;
}

}  // namespace patchlight
