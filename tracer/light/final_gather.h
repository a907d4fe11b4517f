#pragma once
#include "pipeline/optics/surface/coat_albedo.h"
#include "tracer/light/lamps/tile_light.h"
#include "tracer/light/solution/solved_surfaces.h"

namespace patchlight {

/// A point whose irradiance is to be gathered.
struct GatherPoint {
  ShadingPoint shading;
  Vec3f geometric_normal{0.0f};  ///< Directions below this horizon are left out.
  std::uint32_t sample = 0;      ///< Of the pixel.
  std::uint32_t bounce = 0;      ///< Surfaces on the path before the point.
};

/// Irradiance by rays over the hemisphere that look the solution up where they end (final gathering: Reichert 1992),
/// without the direct light of sampled emitters, which TileLight adds.
///
/// The solution is not interpolated at the point itself. Rays are reflected at metals and coats; after a
/// reflection they include sampled emitters, so caustics count exactly once. The rays of all samples of a
/// pixel are stratified together.
class FinalGather {
 public:
  FinalGather(const PatchSet& scene, const RayScene& ray_scene, const SolvedSurfaces& surfaces, const LightMixes& mixes,
              int rays);

  /// Adds the light reflected at `points` to the pixels of a window, and to `layers` unless null.
  void add(std::span<const GatherPoint> points, const TileWindow& window, std::span<Color> pixels,
           LayerSums* layers) const;

 private:
  struct GatherRay;
  struct Gathered;

  std::vector<Gathered> gather(std::span<const GatherPoint> points, const TileWindow& window) const;
  void trace(RayPacket& packet, std::array<GatherRay, RayPacket::kSize>& rays, std::vector<Gathered>& gathered) const;
  bool pass(const SurfaceHit& hit, int lane, RayPacket& packet, GatherRay& ray, Gathered& gathered) const;
  void add_sky(const Vec3f& direction, const GatherRay& ray, Gathered& gathered) const;
  void add_surface(const SurfaceHit& hit, const Vec3f& direction, const GatherRay& ray, Gathered& gathered) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const SolvedSurfaces& surfaces_;
  const LightMixes& mixes_;
  const int rays_;
  const CoatAlbedos coats_;
  std::vector<bool> sampled_;  ///< [patches]: belongs to an sampled emitter.
};

}  // namespace patchlight
