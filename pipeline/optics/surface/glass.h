#pragma once
#include "pipeline/optics/surface/specular.h"

namespace patchlight {

/// Reflectance of a surface that lets light pass, for the cosine of the angle to a facet. `inside`: of a body, where
/// the reflection may be total.
Color glass_reflectance(const SpecularProperties& specular, const Transmission& transmission, float cosine,
                        bool inside);

/// Cosine of the angle to the normal inside of a body of index `ior`, for that outside (Snell's law).
float inner_cosine(float ior, float outside);

/// The part of light that is left after a way of this length in a body, m.
Color unabsorbed(const Transmission& transmission, float length);

/// Whether glass may turn the light that passes it: the surface of a body, or rough.
bool turns_light(const Material& material);

/// Where a ray entered a body of glass.
struct GlassEntry {
  std::int32_t primitive = -1;  ///< -1: it is in none.
  Vec3f normal{0.0f};
};

/// Whether a ray passes a body as a thin plate of smooth glass with parallel faces, which gives it its direction back
/// nearly at its place. `exit`: normal where it leaves the body; `length`: of the way in the body along it, m.
bool is_plate(const PatchSet& scene, const GlassEntry& entry, const Vec3f& exit, float length);

/// The two ways on from a facet of glass: unit vectors, and the part of the light that goes there. What passes is yet
/// to be multiplied by the part that is transmitted at all, and by its tint.
struct GlassWays {
  Vec3f reflection{0.0f}, passage{0.0f};
  Color reflected{0.0f}, passed{0.0f};
};

/// For a ray in `direction` (unit vector, towards the surface). `normal`: on the ray's side. The point `at` of the unit
/// square selects a facet of a rough surface (Walter et al. 2007, "Microfacet models for refraction through rough
/// surfaces"). A thin sheet passes light straight; a rough one as if it reflected it and then mirrored it by its plane,
/// as glTF has it.
GlassWays glass_ways(const SpecularProperties& specular, const Transmission& transmission, const Vec3f& normal,
                     bool inside, const Vec2f& at, const Vec3f& direction);

}  // namespace patchlight
