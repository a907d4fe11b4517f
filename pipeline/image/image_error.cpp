#include "pipeline/image/image_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

constexpr int kBlockSize = 8;
constexpr double kTrimmedFraction = 0.001;  // fraction of the worst pixels that relmse ignores
constexpr double kEmitterThreshold = 0.9;   // the bias ignores pixels above this fraction of the brightest
constexpr double kSoftening = 0.01;         // relative to the mean, to avoid division by zero

double finite_channel(const Color& pixel, int k) {
  return std::isfinite(pixel[k]) ? double(pixel[k]) : 0.0;
}

/// a / b; 0 if a is 0, so that a channel that is black in both images has no error.
double quotient(double a, double b) {
  return a == 0 ? 0 : a / b;
}

Vec3d mean_of(const Image& image) {
  Vec3d sum(0.0);
  for (const Color& pixel : image.pixels)
    for (int k = 0; k < 3; ++k) sum[k] += finite_channel(pixel, k);
  return sum / double(image.pixels.size());
}

/// Means of all whole 8 x 8 blocks.
std::vector<Vec3d> blocks_of(const Image& image) {
  std::vector<Vec3d> blocks;
  for (int top = 0; top + kBlockSize <= image.height; top += kBlockSize)
    for (int left = 0; left + kBlockSize <= image.width; left += kBlockSize) {
      Vec3d sum(0.0);
      for (int y = top; y < top + kBlockSize; ++y)
        for (int x = left; x < left + kBlockSize; ++x)
          for (int k = 0; k < 3; ++k) sum[k] += finite_channel(image.pixels[std::size_t(y) * image.width + x], k);
      blocks.push_back(sum / double(kBlockSize * kBlockSize));
    }
  return blocks;
}

void compare_blocks(const Image& frame, const Image& reference, const Vec3d& mean, ImageError& error) {
  const std::vector<Vec3d> a = blocks_of(frame), b = blocks_of(reference);
  error.block = error.blockrms = a.empty() ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double d = std::abs(a[i][k] - b[i][k]), m = mean[k];
      error.block += quotient(d, b[i][k] + kSoftening * m);
      error.blockrms += quotient(d * d, b[i][k] * b[i][k] + kSoftening * m * m);
    }
  error.block /= 3.0 * double(a.size());
  error.blockrms = std::sqrt(error.blockrms / (3.0 * double(a.size())));
}

double trimmed_relmse(const Image& frame, const Image& reference, const Vec3d& mean) {
  std::vector<double> errors;
  errors.reserve(frame.pixels.size());
  for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double r = finite_channel(reference.pixels[i], k), d = finite_channel(frame.pixels[i], k) - r;
      sum += quotient(d * d, r * r + kSoftening * mean[k] * mean[k]);
    }
    errors.push_back(sum / 3);
  }
  std::sort(errors.begin(), errors.end());
  errors.resize(std::size_t(std::ceil(double(errors.size()) * (1 - kTrimmedFraction))));
  double sum = 0;
  for (const double e : errors) sum += e;
  return sum / double(errors.size());
}

double bias_of(const Image& frame, const Image& reference) {
  float brightest = 0;
  for (const Color& r : reference.pixels) brightest = std::max({brightest, r.x, r.y, r.z});
  double frame_sum = 0, reference_sum = 0, frame_all = 0, reference_all = 0;
  for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
    const Color& r = reference.pixels[i];
    double a = 0, b = 0;
    for (int k = 0; k < 3; ++k) {
      a += finite_channel(frame.pixels[i], k);
      b += finite_channel(r, k);
    }
    const bool included = double(std::max({r.x, r.y, r.z})) < kEmitterThreshold * double(brightest);
    frame_all += a;
    reference_all += b;
    frame_sum += included ? a : 0;
    reference_sum += included ? b : 0;
  }
  return reference_sum > 0 ? frame_sum / reference_sum - 1 : quotient(frame_all - reference_all, reference_all);
}

}  // namespace

Image box_reduced(const Image& image, int height) {
  const int k = height > 0 ? image.height / height : 0;
  if (k < 1 || k * height != image.height || image.width % k != 0)
    throw Error(ExitCode::bad_data,
                fmt::format("{} x {} pixels do not average down to {} rows", image.width, image.height, height),
                "image error", "make one image's sides a whole multiple of the other's: trace.resolution");
  if (k == 1) return image;
  Image result{image.width / k, height, {}, image.metadata};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < result.width; ++x) {
      Vec3d sum(0.0);
      for (int dy = 0; dy < k; ++dy)
        for (int dx = 0; dx < k; ++dx)
          sum += Vec3d(image.pixels[std::size_t(y * k + dy) * image.width + std::size_t(x * k + dx)]);
      result.pixels.push_back(Color(Vec3f(sum / double(k * k))));
    }
  return result;
}

ImageError image_error(const Image& frame, const Image& reference) {
  const int height = std::min(frame.height, reference.height);
  const Image a = box_reduced(frame, height), b = box_reduced(reference, height);
  if (a.width != b.width)
    throw Error(
        ExitCode::bad_data,
        fmt::format("{} x {} pixels against {} x {}", frame.width, frame.height, reference.width, reference.height),
        "image error", "give both images the same aspect ratio: trace.resolution");
  const Vec3d mean = mean_of(b);
  ImageError error;
  compare_blocks(a, b, mean, error);
  error.relmse = trimmed_relmse(a, b, mean);
  error.bias = bias_of(a, b);
  return error;
}

}  // namespace patchlight
