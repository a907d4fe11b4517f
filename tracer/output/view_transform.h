#pragma once
#include <memory>
#include <string>

#include "pipeline/image/image_file.h"

namespace patchlight {

/// From scene-linear Rec.709 radiance to what a display shows, through a view of $OCIO's config, or of the one that
/// Patchlight ships.
class ViewTransform {
 public:
  /// Throws: Error (bad_config) for a view that the config does not have; (missing_input, bad_data) for a bad $OCIO.
  ViewTransform(const std::string& view, double exposure);
  ~ViewTransform();

  /// Values in [0,1]; what is not finite or negative counts as zero, what is infinite as the largest half float.
  Image operator()(const Image& linear) const;

 private:
  struct Processor;
  std::unique_ptr<Processor> processor_;
  float gain_;
};

}  // namespace patchlight
