#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

/// A density of points over a patch, in proportion to how much of what is around them they see: the fraction of their
/// rays that hit no unlit back. With it, the irradiance of a patch that lies partly inside a body, under one that
/// stands on it, or outside of a room is the mean as the other patches see it: E[H V] / E[V] instead of E[H]. So its
/// radiosity times E[V] is the light that leaves it, no light is lost or made, and no mean is divided by a guessed
/// area.
///
/// Rays that hit nothing count as unlit backs if points that see lit surfaces but no backs have no such rays: as
/// outside of a room.
class VisibleDensity {
 public:
  /// Measures the openness V by two rays at one point of each cell. Uniform for patches with an alpha mask.
  VisibleDensity(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, std::uint64_t random);

  bool is_uniform() const { return visible_fraction_ == 1.0f; }

  /// Maps uniform points of the unit square to points of this density.
  Vec2f operator()(const Vec2f& at) const;

  /// E[V]^2 / E[V^2], in (0,1]: the part of the area that is visible, if the rest is not visible at all.
  float visible_fraction() const { return visible_fraction_; }

  static constexpr int kCells = 24;                  ///< Along a side of the unit square.
  static constexpr int kRays = 2 * kCells * kCells;  ///< That the constructor casts.

 private:
  void accumulate();
  /// The point of a cell where its openness is measured.
  Vec2f point(int cell) const;

  std::uint64_t random_ = 0;
  std::vector<float> cell_sums_;        ///< [kCells * kCells] Relative probability of each row's cells up to this one.
  std::array<float, kCells> row_sums_;  ///< The same of rows.
  float visible_fraction_ = 1.0f;
};

/// The densities of the patches of which some part is not visible.
class VisibleDensities {
 public:
  VisibleDensities() = default;
  /// `visible_fractions`: see TransportRows. Patches with a fraction below 1 get the density from which that fraction
  /// was computed, if the seed is the same.
  VisibleDensities(const PatchSet& scene, const RayScene& ray_scene, const std::vector<float>& visible_fractions,
                   std::uint64_t seed);

  /// The density of a patch; null: uniform.
  const VisibleDensity* find(std::int32_t patch) const {
    const auto at = densities_.find(patch);
    return at == densities_.end() ? nullptr : &at->second;
  }

 private:
  std::unordered_map<std::int32_t, VisibleDensity> densities_;
};

/// Random number of a patch's density in a solve with this seed.
std::uint64_t visible_density_random(std::uint64_t seed, std::int32_t patch);

}  // namespace patchlight
