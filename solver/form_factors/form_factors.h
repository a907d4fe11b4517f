#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// One passing-on of a patch's light.
struct Shot {
  std::int32_t patch = 0;
  std::uint32_t rays = 0;  ///< Where form factors are found by rays: how many, a multiple of 16.
  std::uint64_t skip = 0;  ///< Samples that the patch has used before: its sequence goes on behind them.
};

/// F_ij from the shooting patch i; dimensionless.
struct FormFactor {
  std::int32_t patch = 0;
  float value = 0.0f;
};

/// Where rows of form factors come from. The same shots give the same rows for any number of threads.
class FormFactorSource {
 public:
  virtual ~FormFactorSource() = default;

  /// How many of the first of `shots` to ask for at once.
  virtual std::size_t batch(std::span<const Shot> shots) const = 0;

  /// For each shot the form factors to what it reaches, in any order, a patch perhaps several times; their sum is one
  /// less what escapes or meets an unlit back. Shape: [shots].
  virtual std::vector<std::span<const FormFactor>> rows(std::span<const Shot> shots) = 0;
};

}  // namespace patchlight
