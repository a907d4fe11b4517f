#pragma once
#include <memory>

#include "pipeline/image/image_file.h"
#include "pipeline/job/job.h"

namespace patchlight {

/// Converts scene-linear Rec.709 radiance to display values by a look and a view of an OpenColorIO config,
/// view_config_file().
class ViewTransform {
 public:
  /// Throws: Error (bad_config) for a view or look that the config does not have; (missing_input, bad_data) for a bad
  /// config.
  explicit ViewTransform(const PictureConfig& picture);
  ~ViewTransform();

  /// Values in [0,1]. NaN and negative radiance count as 0, infinity as the largest half float.
  Image operator()(const Image& linear) const;

 private:
  struct Processor;
  std::unique_ptr<Processor> processor_;
  float gain_;
};

}  // namespace patchlight
