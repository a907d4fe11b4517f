#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/model/light.h"

namespace patchlight {

/// The measurement of a luminaire, as a photometric file has it.
struct Photometry {
  LightDistribution distribution;
  double candela = 0.0;  ///< Largest luminous intensity; 0: the luminaire is dark.
  std::vector<std::pair<double, double>>
      tilt;  ///< Ascending tilts of the luminaire, degrees, and factors on its light.

  /// Factor on the light of a luminaire whose nadir is turned out of the vertical by this angle, in degrees.
  double tilt_factor(double degrees) const;
};

/// Reads the file that TILT= names, relative to the photometric file.
using ReadTiltFile = std::function<std::string(const std::string& name)>;

/// Reads IES LM-63 of 1986 to 2019, or EULUMDAT if the name ends in .ldt and the text has no line TILT=.
/// Throws: Error (bad_data) with the name and the line for anything that is malformed; Error (over_limit).
Photometry read_photometry(std::string_view text, const std::string& name, const ReadTiltFile& read_tilt_file);

}  // namespace patchlight
