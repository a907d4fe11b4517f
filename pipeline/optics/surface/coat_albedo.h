#pragma once
#include <array>
#include <memory>
#include <vector>

#include "pipeline/optics/surface/specular.h"

namespace patchlight {

/// Directional albedos of the coats of a scene: what their GGX facets reflect once, of light from one direction. The
/// rest passes the coat, so that with the diffuse part below it energy is conserved (Kulla and Conty 2017, "Revisiting
/// physically based shading at Imageworks").
///
/// Tables of 1,024 samples a node, interpolated: within 0.003 of the integral.
class CoatAlbedos {
 public:
  explicit CoatAlbedos(const PatchSet& scene);

  /// Whether the scene has coats.
  bool any() const { return !tables_.empty(); }

  /// Part of light at an angle of this cosine to the normal that the coats reflect, the clear coat included.
  /// `specular`: at a point of the scene.
  Color at(const SpecularProperties& specular, float cosine) const;

  /// Its mean over all directions, weighted by the cosine.
  Color mean(const SpecularProperties& specular) const;

 private:
  struct Table;
  /// Albedos for a reflectance of 1, and of fresnel_rise().
  using Pair = std::array<float, 2>;

  /// The albedo, from `mirror`, the pair of a perfect mirror, or from at_node(r), those of the table's roughnesses.
  template <class AtNode>
  static Color albedo(const SpecularProperties& specular, const Pair& mirror, AtNode at_node);

  const Table& table(float ior) const;
  Color of_coat(const SpecularProperties& specular, float cosine) const;
  Color mean_of_coat(const SpecularProperties& specular) const;

  std::vector<std::shared_ptr<const Table>> tables_;  ///< One for each index of refraction.
};

}  // namespace patchlight
