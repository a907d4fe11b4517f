#pragma once
#include <cstdint>
#include <memory>

#include "solver/linear/spectrum.h"

namespace patchlight {

/// Radiosity of several fields, W/m2, interleaved for gathering: the values of all fields at an element are adjacent,
/// in as few cache lines as possible. Values that are not set are zero.
class RadiosityTable {
 public:
  enum class Precision { single, full };

  /// Largest number of fields. Gathering several fields at once pays because access to an element dominates its cost.
  static constexpr std::size_t kMaxFields = 5;

  RadiosityTable(std::size_t fields, std::size_t elements, Precision precision)
      : elements_(elements),
        precision_(precision),
        width_(fields > 2   ? 16
               : fields > 1 ? 8
                            : 4),
        lines_(std::make_unique<Line[]>(elements * width_ * number_bytes() / sizeof(Line) + 1)) {}

  void set(std::size_t field, std::size_t element, const Spectrum& value) {
    if (precision_ == Precision::single)
      put(reinterpret_cast<float*>(lines_.get()) + element * width_ + 3 * field, value);
    else
      put(reinterpret_cast<double*>(lines_.get()) + element * width_ + 3 * field, value);
  }

  /// Adds to a value.
  void add(std::size_t field, std::size_t element, const Spectrum& value) {
    const std::size_t at = element * width_ + 3 * field;
    if (precision_ == Precision::single)
      for (int c = 0; c < 3; ++c) reinterpret_cast<float*>(lines_.get())[at + std::size_t(c)] += float(value.c[c]);
    else
      for (int c = 0; c < 3; ++c) reinterpret_cast<double*>(lines_.get())[at + std::size_t(c)] += value.c[c];
  }

  std::size_t elements() const { return elements_; }
  Precision precision() const { return precision_; }

  /// Numbers from one element to the next: 4, 8 or 16.
  std::size_t width() const { return width_; }

  /// Shape: [elements][width]. `Number`: float for single precision, double for full.
  template <class Number>
  const Number* values() const {
    return reinterpret_cast<const Number*>(lines_.get());
  }

 private:
  struct alignas(64) Line {
    unsigned char bytes[64];
  };

  std::size_t number_bytes() const { return precision_ == Precision::single ? sizeof(float) : sizeof(double); }

  template <class Number>
  static void put(Number* to, const Spectrum& value) {
    for (int c = 0; c < 3; ++c) to[c] = Number(value.c[c]);
  }

  std::size_t elements_;
  Precision precision_;
  std::size_t width_;
  std::unique_ptr<Line[]> lines_;
};

}  // namespace patchlight
