#pragma once
#include "tracer/light/solved_surfaces.h"
#include "tracer/light/tile_light.h"

namespace patchlight {

/// A point whose irradiance is to be gathered.
struct GatherPoint {
  ShadingPoint at;
  Vec3f flat{0.0f};          ///< The primitive's own normal: nothing arrives from below it.
  std::uint32_t sample = 0;  ///< Of the pixel's.
  std::uint32_t bounce = 0;  ///< Surfaces on the way to it.
};

/// Irradiance at points by rays over their hemispheres, which look the solution up where they end (final gathering:
/// Reichert 1992), but for what comes straight from emitters that are sampled apart: PixelLight finds it.
///
/// Nothing is interpolated at the points themselves. Rays go on through metals as those of the solver do, and show
/// emitters that they meet by way of these, so that caustics count once. The rays of all samples of a pixel are
/// stratified together.
class FinalGather {
 public:
  FinalGather(const PatchSet& scene, const RayScene& ray_scene, const SolvedSurfaces& surfaces, const LightMixes& mixes,
              int rays);

  /// Adds to the pixels of a window, and to `layers` unless null, what `points` reflect.
  void add(std::span<const GatherPoint> points, const TileLight::Window& window, std::span<Color> pixels,
           LayerSums* layers) const;

 private:
  struct Lane;
  struct Arrived;

  std::vector<Arrived> gather(std::span<const GatherPoint> points, const TileLight::Window& window) const;
  void trace(RayPacket& packet, std::array<Lane, RayPacket::kSize>& lanes, std::vector<Arrived>& arrived) const;
  void look_up_sky(const Vec3f& direction, const Lane& lane, Arrived& arrived) const;
  void look_up(const SurfaceHit& hit, const Lane& lane, Arrived& arrived) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const SolvedSurfaces& surfaces_;
  const LightMixes& mixes_;
  const int rays_;
  std::vector<bool> explicit_;  ///< [patches]: of emitters that are sampled apart.
};

}  // namespace patchlight
