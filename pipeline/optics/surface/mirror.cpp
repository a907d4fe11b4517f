#include "pipeline/optics/surface/mirror.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

/// Samples the visible normals of a GGX surface, seen along `view` (about +Z) (Heitz 2018, listing 1).
Vec3f visible_normal(const Vec3f& view, float alpha, float x, float y) {
  const Vec3f stretched = Vec3f(alpha * view.x, alpha * view.y, view.z).normalized();
  const float sine2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3f t = sine2 > 0 ? Vec3f(-stretched.y, stretched.x, 0.0f) / std::sqrt(sine2) : Vec3f(1.0f, 0.0f, 0.0f);
  const Vec3f b = stretched % t;
  const float radius = std::sqrt(x), angle = float(2 * kPi) * y;
  const float p = radius * std::cos(angle);
  const float blend = 0.5f * (1.0f + stretched.z);
  const float q = (1.0f - blend) * std::sqrt(1.0f - p * p) + blend * radius * std::sin(angle);
  const Vec3f n = t * p + b * q + stretched * std::sqrt(std::max(0.0f, 1.0f - p * p - q * q));
  return Vec3f(alpha * n.x, alpha * n.y, std::max(1e-6f, n.z)).normalized();
}

/// Smith's Lambda function of the GGX distribution.
float smith_lambda(const Vec3f& direction, float alpha) {
  const float cos2 = direction.z * direction.z;
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * (1.0f - cos2) / cos2) - 1.0f);
}

}  // namespace

bool reflect(const SpecularProperties& specular, const Vec3f& normal, const Vec2f& at, Vec3f& direction,
             Color& throughput) {
  if (specular.roughness < kMirrorRoughness) {
    throughput *= specular.reflectance(-(direction ^ normal));
    direction -= normal * (2.0f * (normal ^ direction));
    return true;
  }
  const float alpha = specular.roughness * specular.roughness;
  Vec3f tangent, bitangent;
  orthonormal_frame(normal, tangent, bitangent);
  const Vec3f view(-(direction ^ tangent), -(direction ^ bitangent), std::max(-(direction ^ normal), 1e-6f));
  const Vec3f half = visible_normal(view, alpha, at.x, at.y);
  const Vec3f out = half * (2.0f * (view ^ half)) - view;
  if (out.z <= 1e-6f) return false;
  const float lambda_view = smith_lambda(view, alpha);
  throughput *= specular.reflectance(view ^ half);
  throughput *= (1.0f + lambda_view) / (1.0f + lambda_view + smith_lambda(out, alpha));  // G2 / G1
  direction = (tangent * out.x + bitangent * out.y + normal * out.z).normalized();
  return true;
}

Vec3f visible_facet(float roughness, const Vec3f& normal, const Vec2f& at, const Vec3f& direction) {
  if (roughness < kMirrorRoughness) return normal;
  Vec3f tangent, bitangent;
  orthonormal_frame(normal, tangent, bitangent);
  const Vec3f view(-(direction ^ tangent), -(direction ^ bitangent), std::max(-(direction ^ normal), 1e-6f));
  const Vec3f facet = visible_normal(view, roughness * roughness, at.x, at.y);
  return (tangent * facet.x + bitangent * facet.y + normal * facet.z).normalized();
}

SpecularLobe specular_lobe(float roughness, const Vec3f& normal, const Vec3f& in, const Vec3f& out) {
  const float alpha = roughness * roughness;
  const Vec3f view = -in;
  const float cos_view = std::max(view ^ normal, 1e-6f), cos_out = out ^ normal;
  if (cos_out <= 1e-6f) return {};
  const float cos_half = (view + out).normalized() ^ normal;
  const float denominator = cos_half * cos_half * (alpha * alpha - 1.0f) + 1.0f;
  const float distribution = alpha * alpha / (float(kPi) * denominator * denominator) / (4.0f * cos_view);
  const float lambda_view = smith_lambda({0, 0, cos_view}, alpha), lambda_out = smith_lambda({0, 0, cos_out}, alpha);
  return {distribution / (1.0f + lambda_view + lambda_out), distribution / (1.0f + lambda_view)};
}

}  // namespace patchlight
