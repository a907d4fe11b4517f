#pragma once
#include <span>
#include <vector>

#include "pipeline/optics/direct_light.h"
#include "pipeline/optics/shadow_rays.h"

namespace patchlight {

/// A point that a path of a pixel sample has come to.
struct ShadingPoint {
  std::uint32_t pixel = 0;  ///< Of the tile.
  std::int32_t primitive = 0;
  Vec3d position{0.0};  ///< Where shadow rays start: off the surface.
  Vec3f normal{0.0f};
  Color weight{0.0f};  ///< What the pixel gets for irradiance there, 1/sr.
};

/// Direct light at the pixels of a tile, of emitters that are sampled apart: closed forms where all of an emitter is
/// seen, samples where it is partly hidden, stratified jointly over a pixel's points on a primitive.
///
/// A few pilot samples for each pixel say which it is. Where those of a pixel and its neighbours agree that all is seen
/// or all is hidden they are believed, so that at the rim of a penumbra some hundredths of an emitter may be missed. An
/// emitter that brings a place less than a hundredth of its light gets one sample there, and no more.
class PixelLight {
 public:
  /// `emission`: exitance of every patch, W/m2, under the settings of the lights.
  PixelLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& emission);

  /// Adds to `pixels` what `points` reflect straight from emitters. The tile is `width` pixels wide. The points are put
  /// in order. `seed` tells tiles apart.
  void add(std::vector<ShadingPoint>& points, int width, std::uint64_t seed, std::span<Color> pixels) const;

 private:
  struct Lamp {
    DirectLight light;
    std::int32_t primitive;
    Color exitance;
  };
  struct Spot;
  class Tile;

  const RayScene& ray_scene_;
  std::vector<Lamp> lamps_;
};

}  // namespace patchlight
