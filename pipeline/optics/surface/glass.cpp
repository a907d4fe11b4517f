#include "pipeline/optics/surface/glass.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/surface/mirror.h"

namespace patchlight {

namespace {

/// Cosine outside of a body, for that inside; 0 where the reflection is total.
float outer_cosine(float ior, float inside) {
  return std::sqrt(std::max(0.0f, 1.0f - ior * ior * (1.0f - inside * inside)));
}

}  // namespace

Color glass_reflectance(const SpecularProperties& specular, const Transmission& transmission, float cosine,
                        bool inside) {
  if (!inside) return specular.reflectance(cosine);
  const float outside = outer_cosine(transmission.ior, cosine);
  return outside > 0 ? specular.reflectance(outside) : Color(1.0f);
}

float inner_cosine(float ior, float outside) {
  return std::sqrt(1.0f - (1.0f - outside * outside) / (ior * ior));
}

Color unabsorbed(const Transmission& transmission, float length) {
  const Color& a = transmission.absorption;
  return {std::exp(-a.x * length), std::exp(-a.y * length), std::exp(-a.z * length)};
}

bool turns_light(const Material& material) {
  return material.transmission.exists() && (material.transmission.solid || material.roughness >= kMirrorRoughness);
}

bool is_plate(const PatchSet& scene, const GlassEntry& entry, const Vec3f& exit, float length) {
  constexpr float kParallel = 0.99f;  // cosine between the faces
  constexpr double kThin = 1.0 / 8;   // thickness over the extent of a face
  if (entry.primitive < 0 || -(entry.normal ^ exit) < kParallel) return false;
  const Primitive& face = scene.primitives[entry.primitive];
  if (scene.materials[face.material].roughness >= kMirrorRoughness) return false;
  const auto& c = face.corners;
  const double extent = face.shape == Primitive::Shape::sphere
                            ? 2 * std::abs(face.sphere_radius)
                            : std::sqrt(std::max((c[2] - c[0]).length2(), (c[3] - c[1]).length2()));
  return double(length) <= kThin * extent;
}

GlassWays glass_ways(const SpecularProperties& specular, const Transmission& transmission, const Vec3f& normal,
                     bool inside, const Vec2f& at, const Vec3f& direction) {
  GlassWays ways;
  const Vec3f facet = visible_facet(specular.roughness, normal, at, direction);
  const float cosine = std::clamp(-(direction ^ facet), 0.0f, 1.0f);
  ways.reflected = glass_reflectance(specular, transmission, cosine, inside);
  ways.passed = Color(1.0f) - ways.reflected;
  // What would end behind the surface leaves it all the same, as if mirrored by its plane, so that no light is lost.
  const auto on_side = [&](const Vec3f& way, float side) {
    const float height = way ^ normal;
    return height * side < 0 ? way - normal * (2.0f * height) : way;
  };
  const Vec3f reflection = (direction + facet * (2.0f * cosine)).normalized();
  ways.reflection = on_side(reflection, 1.0f);
  if (transmission.solid) {
    const float ior = inside ? transmission.ior : 1.0f / transmission.ior;
    const float squared = std::max(0.0f, 1.0f - ior * ior * (1.0f - cosine * cosine));
    ways.passage = on_side((direction * ior + facet * (ior * cosine - std::sqrt(squared))).normalized(), -1.0f);
  } else {
    ways.passage = facet == normal ? direction : on_side(ways.reflection, -1.0f);
  }
  return ways;
}

}  // namespace patchlight
