#pragma once
#include <span>
#include <vector>

#include "pipeline/optics/lights/further_lights.h"
#include "pipeline/optics/lights/shadow_rays.h"
#include "tracer/light/lamps/shading_cluster.h"

namespace patchlight {

/// Direct light of a scene's FurtherLights at shading clusters. A LightTree chooses emitters by power and position;
/// each counts by its closed form, less what shadow rays miss of it. An emissive quad with a picture is an emitter for
/// each of its patches.
class FurtherLight {
 public:
  /// `settings`: of the light groups.
  FurtherLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings);

  bool empty() const { return lights_.empty(); }
  bool is_off() const { return off_; }  ///< All its emitters are, under the settings.
  const FurtherLights& lights() const { return lights_; }
  std::size_t groups() const { return settings_.size(); }
  const Color& setting(std::size_t group) const { return settings_[group]; }

  /// What samples of a cluster found.
  class Samples {
   public:
    int count = 0;          ///< Number of choices.
    Visibility visibility;  ///< Of their shadow rays.

    /// Irradiance by a light group at the scene's own strength, W/m2. `mostly_visible`, by other samples, selects the
    /// estimate with less noise; both are right in the mean.
    Color light(std::size_t group, bool mostly_visible) const;
    /// light() of all groups, sum of channels.
    float brightness() const;

   private:
    friend class FurtherLight;
    struct Sums {
      Color whole{0.0f};   ///< All light without occlusion,
      Color missed{0.0f};  ///< the part of occluded shadow rays,
      Color seen{0.0f};    ///< and of the others; each times `count`.
    };
    std::vector<Sums> by_group_;
  };

  using Choices = std::vector<LightTree::Choice>;
  /// A power of two of choices that serve all clusters of a receiver; empty where the receiver is too large for that.
  Choices choose(const LightTree::Receiver& receiver, int count, std::uint64_t seed) const;

  /// Adds `count` emitters, a power of two, and as many shadow rays to a cluster's samples. Takes them from `choices`
  /// if there are as many.
  void sample(const ShadingCluster& cluster, const Choices& choices, int count, std::uint64_t seed,
              Samples& samples) const;

  std::int32_t group(std::int32_t emitter) const { return lamps_[emitter].group; }
  /// Exitance, W/m2 at the scene's own strength, of an emitter where a shadow ray from `start` reaches it; black where
  /// the alpha mask lets the ray pass.
  Color exitance(std::int32_t emitter, const Vec3d& start, const DirectLight::Sample& ray) const;

 private:
  FurtherLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings,
               const std::vector<Emitter>& emitters);

  struct Chosen;
  /// What sampling needs to know of an emitter.
  struct Lamp {
    std::int32_t primitive = 0, group = 0;
    bool uniform = true;   ///< All its parts have the same exitance,
    Color exitance{0.0f};  ///< this one, W/m2.
  };

  void cast(const ShadingCluster& cluster, std::span<const Chosen> chosen, std::uint64_t seed, Samples& samples) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const FurtherLights lights_;
  std::vector<Lamp> lamps_;  ///< [emitters of `lights_`].
  const std::vector<Color> settings_;
  bool off_ = true;
};

}  // namespace patchlight
