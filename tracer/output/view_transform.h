#pragma once
#include <memory>
#include <string>

#include "pipeline/image/image_file.h"

namespace patchlight {

/// Converts scene-linear Rec.709 radiance to display values by a view of the OpenColorIO config in $OCIO, or of the
/// config that Patchlight ships.
class ViewTransform {
 public:
  /// `exposure`: in stops.
  /// Throws: Error (bad_config) for a view that the config does not have; (missing_input, bad_data) for a bad $OCIO.
  ViewTransform(const std::string& view, double exposure);
  ~ViewTransform();

  /// Values in [0,1]. NaN and negative radiance count as 0, infinity as the largest half float.
  Image operator()(const Image& linear) const;

 private:
  struct Processor;
  std::unique_ptr<Processor> processor_;
  float gain_;
};

}  // namespace patchlight
