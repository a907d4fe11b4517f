#pragma once
#include <vector>

#include "pipeline/optics/lights/plane_mirror.h"
#include "tracer/light/lamps/further_light.h"

namespace patchlight {

/// Sampled emitters as reflected by rough metals and coats, also where a large plane mirror shows them there: as
/// virtual images. A reflected path rarely hits a small emitter, and a ray towards a near emitter rarely lies in their
/// lobe; so both are sampled and combined by multiple importance sampling with the balance heuristic (Veach and Guibas
/// 1995).
class GlossyLights {
 public:
  /// The lights must outlive it.
  GlossyLights(const PatchSet& scene, const RayScene& ray_scene, const ExplicitLights& lights,
               const FurtherLight& further);

  /// Whether the scene has rough metals or coats.
  static bool is_needed(const PatchSet& scene);

  /// Path vertex on a rough metal or coat.
  struct Vertex {
    Vec3d position{0.0};  ///< Offset from the surface.
    Vec3f normal{0.0f};
    Vec3f direction{0.0f};  ///< Of the incoming path, towards the surface.
    float roughness = 0.0f;
  };

  /// A ray from a vertex to an emitter.
  struct Sample {
    Vec3f direction{0.0f};
    float distance = 0.0f;
    float weight = 0.0f;  ///< Factor of the emitter's radiance times the reflectance; 0: no contribution.
    std::int32_t group = 0;
    Color exitance{0.0f};  ///< Of the emitter at the scene's own strength, W/m2; of a Light, its strength.
    /// The way from a mirror, where the ray ends, to the emitter itself.
    struct Reflected {
      Vec3d position{0.0};
      Vec3f direction{0.0f};
      float distance = 0.0f;  ///< 0: no mirror is on the way.
    };
    Reflected reflected{};
  };
  /// `choice`, in [0,1), selects the emitter, `at`, in [0,1)^2, the point on it.
  Sample sample(const Vertex& vertex, float choice, const Vec2f& at) const;

  /// The number of a primitive among the mirrors that show images; -1: it is none.
  std::int32_t mirror(std::int32_t primitive) const;

  /// MIS weight, in [0,1], of the emission of `patch`, hit in `direction` by a path that left `vertex` with the density
  /// `pdf`, per sr. `mirror`: which reflected it since; -1: none.
  float hit_weight(const Vertex& vertex, const Vec3f& direction, float pdf, std::int32_t patch,
                   std::int32_t mirror) const;

 private:
  /// A lamp, or its virtual image by a mirror.
  struct Source {
    const ExplicitLights::Lamp* lamp;
    DirectLight light;
    std::int32_t mirror;  ///< -1: the lamp itself.
    Vec3d sun;            ///< Direction to a sun; zero: no sun.
    float brightness;     ///< Sum of the channels, as the mirror shows it.
  };

  /// Relative probabilities by which sample() selects the sources, unnormalised: their light times the lobe towards
  /// their middles. Returns their sum.
  float selection_weights(const Vertex& vertex, std::vector<float>& weights) const;
  /// The same of all further lights together.
  float further_weight(const Vertex& vertex) const;
  Sample sample_lamp(const Source& source, const Vertex& vertex, const Vec2f& at, float probability) const;
  Sample sample_further(const Vertex& vertex, double choice, const Vec2f& at, float part) const;

  const ExplicitLights& lights_;
  const FurtherLight& further_;
  std::vector<PlaneMirror> mirrors_;
  std::vector<Source> sources_;                 ///< All lamps, then for each mirror the images of all lamps.
  std::vector<std::int32_t> lamp_of_patch_;     ///< [patches]: index of the lamp; -1: not explicitly sampled.
  std::vector<std::int32_t> further_of_patch_;  ///< [patches]: index of the further light; -1: none.
};

}  // namespace patchlight
