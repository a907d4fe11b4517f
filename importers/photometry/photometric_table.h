#pragma once
#include <vector>

#include "importers/photometry/photometric_text.h"
#include "importers/photometry/photometry.h"

namespace patchlight {

constexpr int kMaxAngles = 3601;               ///< Of one kind, in a file: steps of a tenth of a degree.
constexpr std::size_t kMaxValues = 2'000'000;  ///< Of luminous intensity, in a file.
constexpr double kMaxIntensity = 1e12;         ///< cd

/// What a half-plane of type C says about others.
enum class LateralSymmetry {
  none,        ///< Angles from 0 to 360, or to the last one before.
  rotational,  ///< One half-plane is all of them.
  about_c0,    ///< C and 360 - C are the same.
  about_c90,   ///< C and 180 - C are the same.
  quadrants,   ///< Both.
};

/// Luminous intensities as a file lists them.
struct PhotometricTable {
  LightDistribution::System system = LightDistribution::System::c;
  LateralSymmetry symmetry = LateralSymmetry::none;  ///< Of type C. Others are mirrored where they begin at 0.
  std::vector<double> vertical, horizontal;          ///< Degrees.
  std::vector<double> candela;                       ///< [horizontal][vertical]
};

/// All half-planes of a table, mirrored where it is symmetric.
Photometry expanded(const PhotometricTable& table);

/// Reads a number of angles or values. Throws: Error (bad_data, over_limit).
int read_count(PhotometricText& text, const std::string& what, int most);

/// Reads angles, each larger than the one before and in [low, high] degrees. Throws: Error (bad_data).
std::vector<double> read_angles(PhotometricText& text, int count, const std::string& what, double low, double high);

/// Reads `count` luminous intensities and multiplies them. Throws: Error (bad_data).
std::vector<double> read_intensities(PhotometricText& text, std::size_t count, double factor);

Photometry read_lm63(PhotometricText& text, const ReadTiltFile& read_tilt_file);
Photometry read_eulumdat(PhotometricText& text);

}  // namespace patchlight
