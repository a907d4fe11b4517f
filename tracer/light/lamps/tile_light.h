#pragma once
#include <optional>

#include "pipeline/optics/lights/shadow_rays.h"
#include "tracer/light/lamps/guided_light.h"
#include "tracer/light/lamps/lamp_probes.h"
#include "tracer/light/lamps/tile_further_light.h"
#include "tracer/output/layer_sums.h"

namespace patchlight {

/// Direct light at the pixels of a tile: closed forms where an emitter is fully visible, shadow rays, stratified over a
/// shading cluster, where it is partly hidden.
///
/// Probes from a few points decide how many rays follow: those of a cluster's neighbours, so that its own probes are a
/// fair sample. Where all neighbours see the emitter, or none does, no more rays are cast; what the cluster's own
/// probes say otherwise is spread over the neighbours. Where hardly any probe sees it, a GuidedLight finds what there
/// is. So the light of a tile is right in the mean. A cluster that does not fill its pixel casts probes of its own as
/// well. For an emitter that brings less than three hundredths of a cluster's light, the probes are the estimate, which
/// blurs its shadows by a pixel. A TileFurtherLight adds the emitters beyond the explicit ones.
class TileLight {
 public:
  /// A pixel lit by a single, half hidden lamp takes 8 `samples` rays. `layers` receive the same light as the pixels;
  /// may be null.
  TileLight(const ExplicitLights& lights, const FurtherLight& further, const TileWindow& window, int samples,
            LayerSums* layers = nullptr);

  /// Casts the probes, from points at all pixels, and computes the light of the `requested` pixels from them. Call it
  /// once, before anything else. Shape: requested.size() == window.pixels().
  void probe(std::vector<ShadingPoint> points, std::span<const std::uint8_t> requested);

  /// Whether a shadow edge near a requested pixel is so sharp that its light takes more points.
  bool sharp(std::uint32_t pixel) const { return sharp_[pixel] != 0; }
  /// Adds the light reflected at a point of a requested pixel that is not sharp; false if no probed cluster matches the
  /// point.
  bool add_probed(const ShadingPoint& point, std::span<Color> pixels) const;
  std::span<const ShadingPoint> points(std::uint32_t pixel) const { return clusters_.points(pixel); }

  /// Adds the light reflected at `points`, which must be all points of their pixels, to `pixels`. Sorts the points.
  void add(std::vector<ShadingPoint>& points, std::span<Color> pixels) const;

 private:
  using Lamp = ExplicitLights::Lamp;
  /// Form factors from clusters to unoccluded lamps.
  struct Factors {
    std::vector<float> unoccluded;  ///< [lamps][clusters].
    std::vector<float> total;       ///< [clusters], sum of the form factors times the lamps' brightness.
    std::size_t clusters;

    Factors(const std::vector<Lamp>& lamps, const std::vector<ShadingCluster>& all);
    float of(std::size_t lamp, std::size_t cluster) const { return unoccluded[lamp * clusters + cluster]; }
    float share(const Lamp& lamp, std::size_t l, std::size_t s) const {
      return of(l, s) * lamp.brightness() / total[s];
    }
  };

  std::vector<LightSamples> probe_lamp(std::size_t lamp, const Factors& factors) const;
  /// `visible_light`: of all lamps at the clusters, by the probes, W/m2, sum of channels.
  void add_lamp(std::size_t lamp, const Factors& factors, const std::vector<LightSamples>& probes,
                const std::vector<float>& visible_light, std::span<const std::uint8_t> requested);
  void add_guided(std::size_t lamp, const std::vector<LightSamples>& probes, std::span<const std::uint32_t> dim,
                  std::vector<float>& values, std::vector<float>& residuals) const;
  template <class TakesPart>
  void spread(const std::vector<float>& residuals, TakesPart takes_part, std::vector<float>& values) const;
  /// Adds light at a probed cluster: W/m2 at the scene's own strength, and under the lights' settings.
  void add_light(std::size_t cluster, std::size_t group, const Color& unscaled, const Color& scaled);
  /// Adds the light that a cluster reflects.
  void add_light(const ShadingCluster& cluster, std::size_t group, const Color& unscaled, const Color& scaled,
                 std::span<Color> pixels) const;
  bool by_group() const { return layers_ && layers_->has_groups(); }
  /// Whether the lamp contributes to the pixels or to a layer.
  bool is_needed(const Lamp& lamp) const { return !lamp.is_off() || by_group(); }

  const ExplicitLights& lights_;
  const FurtherLight& further_;
  const TileWindow window_;
  const int samples_;
  LayerSums* const layers_;
  TileClusters clusters_;
  std::optional<TileFurtherLight> tile_further_;
  LampProbes probes_;
  std::vector<std::uint8_t> sharp_;
  std::vector<Color> irradiance_;                        ///< [clusters] W/m2, at requested pixels.
  std::vector<std::vector<Color>> irradiance_by_group_;  ///< [groups][clusters], at the scene's own strength.
};

}  // namespace patchlight
