#pragma once
#include "tracer/light/pixel_light.h"

namespace patchlight {

/// The emitters that are sampled apart as rough metals show them: a path that a metal has turned meets small ones
/// hardly ever, a ray to one that stands near hardly ever goes where the metal reflects to, so both are taken and
/// weighted by multiple importance sampling with the balance heuristic (Veach and Guibas 1995).
class MetalLight {
 public:
  /// `settings`: of the light groups.
  MetalLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings);

  static bool is_of_use(const PatchSet& scene);

  /// Where a path meets a rough metal.
  struct Place {
    Vec3d position;  ///< Off the surface.
    Vec3f normal;
    Vec3f direction;  ///< Of the path, towards the metal.
    float roughness = 0.0f;
  };

  /// A ray from there to an emitter.
  struct Sample {
    Vec3f direction{0.0f};
    float distance = 0.0f;
    float weight = 0.0f;  ///< Of the emitter's radiance times the metal's reflectance; 0: not worth a ray.
    const PixelLight::Lamp* lamp = nullptr;
  };
  /// `choice`, in [0,1), chooses the emitter, `at` the point of it.
  Sample sample(const Place& place, float choice, const Vec2f& at) const;

  /// What the emission of a patch counts for where a path meets it that was turned at `place` with a `density`, per sr.
  float part_hit(const Place& place, const Vec3f& direction, float density, std::int32_t patch) const;

 private:
  /// How likely sample() chooses each lamp, but for a common factor; their sum.
  float chances(const Vec3d& position, std::vector<float>& of_lamps) const;

  PixelLight lights_;
  std::vector<std::int32_t> lamp_of_;  ///< [patches]: -1: not sampled.
};

}  // namespace patchlight
