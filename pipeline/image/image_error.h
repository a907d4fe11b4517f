#pragma once
#include "pipeline/image/image_file.h"

namespace patchlight {

/// Relative errors of a frame I against a reference R. m is the mean of R in a channel.
struct ImageError {
  /// Mean over 8 x 8 blocks and channels of |mean I - mean R| / (mean R + 0.01 m): insensitive to noise.
  double block = 0;
  double blockrms = 0;  ///< Root of the mean over blocks and channels of (mean I - mean R)^2 / (mean R^2 + (0.1 m)^2).
  double relmse = 0;    ///< Mean of (I - R)^2 / (R^2 + (0.1 m)^2) without the worst 0.1% of pixels.
  double bias = 0;      ///< mean I / mean R - 1 over pixels where R < 0.9 max R; over all pixels if there are none.
};

/// The image, scaled down to `height` rows with a box filter.
/// Throws: Error (bad_data) unless both sides are divisible.
Image box_reduced(const Image& image, int height);

/// Compares two images of the same aspect ratio; the larger is scaled down to the smaller with a box filter. NaN and
/// infinities count as 0. Block errors are NaN if the images are smaller than a block.
/// Throws: Error (bad_data) if one size is no multiple of the other.
ImageError image_error(const Image& frame, const Image& reference);

}  // namespace patchlight
