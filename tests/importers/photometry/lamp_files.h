#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight::test {

/// Angles from `first` to `last` degrees.
inline std::vector<double> angles(double first, double last, double step) {
  std::vector<double> all;
  for (double angle = first; angle < last + 0.5 * step; angle += step) all.push_back(angle);
  return all;
}

/// Luminous intensity of a lamp without symmetry, cd, by angles in degrees: to the nadir, and about it.
inline double lopsided(double vertical, double horizontal) {
  const double v = vertical * kPi / 180, h = horizontal * kPi / 180;
  return 1000 * (1.2 + std::cos(v)) * (1 + 0.4 * std::sin(v) * std::cos(h) + 0.3 * std::sin(v) * std::sin(h));
}

/// An LM-63 file of type C without tilt. `of(vertical, horizontal)`: candela.
template <class Of>
std::string ies_text(const std::vector<double>& vertical, const std::vector<double>& horizontal, Of of,
                     const std::string& header = "IESNA:LM-63-1995\n[TEST] none\n", double multiplier = 1,
                     const std::string& factors = "1 1 20") {
  std::string text = header + "TILT=NONE\n";
  text += fmt::format("1 -1 {} {} {} 1 2 0 0 0\n{}\n", multiplier, vertical.size(), horizontal.size(), factors);
  for (const double v : vertical) text += fmt::format("{} ", v);
  text += "\n";
  for (const double h : horizontal) text += fmt::format("{} ", h);
  for (const double h : horizontal) {
    text += "\n";
    for (const double v : vertical) text += fmt::format("{:.4f} ", of(v, h) / multiplier);
  }
  return text + "\n";
}

/// An EULUMDAT file. `of(vertical, plane)`: candela.
template <class Of>
std::string ldt_text(int symmetry, int planes, double flux, const std::vector<double>& vertical, Of of) {
  std::string text =
      fmt::format("Company\r\n1\r\n{}\r\n{}\r\n{}\r\n{}\r\n0\r\n", symmetry, planes, 360.0 / planes, vertical.size());
  for (const char* name : {"report", "luminaire", "number", "file", "date"}) text += std::string(name) + "\r\n";
  for (int size = 0; size < 9; ++size) text += "100\r\n";
  text += "100\r\n80\r\n1.0\r\n0\r\n1\r\n";  // parts of the flux, conversion, tilt, lamp sets
  text += fmt::format("2\r\nLED\r\n{}\r\n3000K\r\n1B\r\n20\r\n", flux);
  for (int ratio = 0; ratio < 10; ++ratio) text += "0.5\r\n";
  for (int plane = 0; plane < planes; ++plane) text += fmt::format("{}\r\n", plane * 360.0 / planes);
  for (const double v : vertical) text += fmt::format("{}\r\n", v);
  const int first = symmetry == 3 ? 3 * planes / 4 : 0;
  const int count = symmetry == 0 ? planes : symmetry == 1 ? 1 : symmetry == 4 ? planes / 4 + 1 : planes / 2 + 1;
  for (int plane = first; plane < first + count; ++plane)
    for (const double v : vertical) text += fmt::format("{:.4f}\r\n", of(v, plane * 360.0 / planes) * 1000 / flux);
  return text;
}

}  // namespace patchlight::test
