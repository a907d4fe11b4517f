#pragma once
#include "pipeline/image/image_file.h"

namespace patchlight {

/// How far a frame is from a reference. All are relative; m is the mean of the reference R in a channel.
struct ImageError {
  double block =
      0;  ///< Mean over 8 x 8 blocks and channels of |mean I - mean R| / (mean R + 0.01 m): noise evened out.
  double blockrms = 0;  ///< Root of the mean over blocks and channels of (mean I - mean R)^2 / (mean R^2 + (0.1 m)^2).
  double relmse = 0;    ///< Mean of (I - R)^2 / (R^2 + (0.1 m)^2) without the worst 0.1% of pixels.
  double bias = 0;      ///< mean I / mean R - 1 where R is below 0.9 of its largest value; everywhere if it nowhere is.
};

/// The image scaled down to `height` rows by averaging whole boxes of pixels.
/// Throws: Error (bad_data) unless both sides are whole multiples.
Image box_reduced(const Image& image, int height);

/// Compares two frames of one shape; the larger is box-averaged down to the smaller. NaN and infinities in the frame
/// count as 0. Blocks are NaN if the frame is smaller than one. Throws: Error (bad_data) for sizes that do not divide.
ImageError image_error(const Image& frame, const Image& reference);

}  // namespace patchlight
