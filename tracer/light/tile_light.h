#pragma once
#include <array>

#include "pipeline/optics/lights/shadow_rays.h"
#include "tracer/light/shading_cluster.h"
#include "tracer/output/layers.h"

namespace patchlight {

/// Direct light at the pixels of a tile: closed forms where all of an emitter is seen, samples where it is partly
/// hidden, stratified jointly over a spot of a pixel.
///
/// A first look from few points tells which it is: where what a spot and those of its surface at neighbouring pixels
/// see agrees that all is seen or all is hidden they are believed, so that at the rim of a penumbra some hundredths of
/// an emitter may be missed. Spots that do not fill their pixel take a look of their own besides. Of an emitter that
/// brings a place less than three hundredths of its light as much is taken to be seen as those looks say, so that its
/// shadows are blurred by a pixel.
class TileLight {
 public:
  /// Pixels of an image from (x0,y0) on.
  struct Window {
    int x0, y0, width, height;

    int pixels() const { return width * height; }
    /// A number of its own for each pixel of the image.
    std::uint64_t place(std::uint32_t pixel) const {
      return std::uint64_t(y0 + int(pixel) / width) << 32 | std::uint64_t(x0 + int(pixel) % width);
    }
  };

  /// A pixel that is lit by one lamp takes 8 `samples` rays where half of it is hidden. `layers`: get what pixels get;
  /// null: none.
  TileLight(const PixelLight& lights, const Window& window, int samples, LayerSums* layers = nullptr);

  /// Takes the first look, from points at all pixels, and from it finds what those of the `wanted` pixels reflect.
  /// Once, before anything else. Shape: wanted.size() == window.pixels().
  void look(std::vector<ShadingPoint> points, std::span<const std::uint8_t> wanted);

  /// Whether the edge of a shadow about a wanted pixel is so sharp that it takes more points to find its light.
  bool sharp(std::uint32_t pixel) const { return sharp_[pixel] != 0; }
  /// Adds what a point at a wanted pixel that is not sharp reflects to `pixels`, if the first look was from its
  /// surface.
  bool add_seen(const ShadingPoint& point, std::span<Color> pixels) const;
  std::span<const ShadingPoint> points(std::uint32_t pixel) const;

  /// Adds to `pixels` what `points` reflect, all that those pixels have. The points are put in order.
  void add(std::vector<ShadingPoint>& points, std::span<Color> pixels) const;

 private:
  using Lamp = PixelLight::Lamp;
  /// Form factors of spots to lamps, as if nothing hid them.
  struct Factors {
    std::vector<float> whole;  ///< [lamps][spots].
    std::vector<float> total;  ///< [spots], times the lamps' brightness.
    std::size_t clusters;

    Factors(const std::vector<Lamp>& lamps, const std::vector<ShadingCluster>& clusters);
    float of(std::size_t lamp, std::size_t cluster) const { return whole[lamp * clusters + cluster]; }
    float share(const Lamp& lamp, std::size_t l, std::size_t s) const {
      return of(l, s) * lamp.brightness() / total[s];
    }
  };

  /// What is seen of a lamp about a place.
  struct About {
    Visibility samples;
    bool sharp = false;  ///< Between some neighbours that see all of it and some that see nothing.
  };
  About about(std::size_t lamp, std::size_t cluster) const;
  Visibility about_pixel(std::size_t lamp, std::uint32_t pixel) const;
  std::int32_t cluster_at(std::uint32_t pixel, std::int32_t surface, const Vec3f& normal) const;
  void find_neighbours();
  void add_to_seen(std::size_t lamp, const Factors& factors, std::span<const std::uint8_t> wanted);
  bool by_group() const { return layers_ && layers_->groups(); }
  /// Whether anyone asks how much of a lamp's light arrives.
  bool is_needed(const Lamp& lamp) const { return !lamp.is_off() || by_group(); }

  const PixelLight& lights_;
  const Window window_;
  const int samples_;
  LayerSums* const layers_;
  std::vector<ShadingPoint> points_;
  std::vector<ShadingCluster> clusters_;
  std::vector<std::uint32_t> first_cluster_;  ///< [pixels + 1].
  /// [spots]: those of the same surface in rows from the upper left pixel to the lower right, itself among them; -1:
  /// none.
  std::vector<std::array<std::int32_t, 9>> neighbours_;
  struct Counts {
    std::uint8_t visible = 0, hidden = 0;
  };
  std::vector<Counts> counts_;  ///< [lamps][spots].
  std::vector<std::uint8_t> sharp_;
  std::vector<Color> seen_;                        ///< [spots] W/m2, at wanted pixels.
  std::vector<std::vector<Color>> seen_of_group_;  ///< [groups][spots], at the scene's own strength, for layers.
};

}  // namespace patchlight
