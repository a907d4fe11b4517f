#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// One distribution of a patch's unshot light to the scene.
struct Shot {
  std::int32_t patch = 0;
  std::uint32_t rays = 0;  ///< For form factors by rays: their number, a multiple of 16.
  std::uint64_t skip = 0;  ///< Samples of the patch's sequence that earlier shots used.
};

/// F_ij from the shooting patch i; dimensionless.
struct FormFactor {
  std::int32_t patch = 0;
  float value = 0.0f;
};

/// Computes rows of form factors. The rows do not depend on the number of threads.
class FormFactorSource {
 public:
  virtual ~FormFactorSource() = default;

  /// Number of leading shots to pass to rows() at once.
  virtual std::size_t batch(std::span<const Shot> shots) const = 0;

  /// For each shot the form factors to the visible patches, in any order; a patch may occur several times. Their sum is
  /// 1 minus what escapes or hits an unlit back. Valid until the next call. Shape: [shots].
  virtual std::vector<std::span<const FormFactor>> rows(std::span<const Shot> shots) = 0;
};

}  // namespace patchlight
