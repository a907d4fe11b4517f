#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/ray_scene.h"

namespace patchlight {

/// How much room a patch, or a part of one, has: its size (the root of its area) over the harmonic mean of the
/// distances that 16 of its rays go (Ward, Rubinstein and Clear 1988); and whether any of them ends on an unlit back.
struct Closeness {
  float value = 0.0f;
  bool to_backs = false;
};
Closeness closeness(const PatchSet& scene, const RayScene& ray_scene, const Patch& part, std::uint64_t random);

/// Whether any two corners of a plane patch do not see each other along it.
bool is_cut(const PatchSet& scene, const RayScene& ray_scene, const Patch& part);

/// Of a place's rays, the part that ends where light may come from or go to: on lit surfaces, or, if no unlit back is
/// in sight, nowhere. (Beside a back, nowhere is mostly below a floor or outside a room.)
float exposure(const RayScene& ray_scene, std::int32_t primitive, const SurfacePoint& point, std::uint64_t random);

/// Which parts of patches are exposed: seen from where light is, and not under or behind something that stands there
/// with its unlit back to them. As others see a patch, its parts count by how much they are exposed; so its own mean
/// must count them, or what is covered would darken the rest.
///
/// A part is the more exposed, the less of its rays end on unlit backs. Both halves of a row have samples of that of
/// their own, so that their difference tells this error too.
class ExposedParts {
 public:
  /// The same for any number of threads. Adds the number of rays to `cast`.
  ExposedParts(const PatchSet& scene, const RayScene& ray_scene, std::uint64_t seed, std::int64_t& cast);

  /// Exposed area of patch i over its area, as half 0 or 1 has it; at least a quarter, and 1 for what is not exposed at
  /// all.
  float part(std::int32_t i, int half) const { return at_[i] < 0 ? 1.0f : grids_[at_[i]][half].mean; }

  /// Whether a sample at (x,y) of the patch's unit square counts, for a `random` number of 64 bits.
  bool keeps(std::int32_t i, int half, float x, float y, std::uint64_t random) const;

 private:
  static constexpr int kAcross = 8;
  struct Grid {
    float mean = 1.0f;
    std::array<float, kAcross * kAcross> kept{};
  };

  static Grid grid_of(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, std::uint64_t random);

  std::vector<std::int32_t> at_;  ///< [patches], -1: all of it is exposed.
  std::vector<std::array<Grid, 2>> grids_;
};

}  // namespace patchlight
