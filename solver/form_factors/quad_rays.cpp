#include "solver/form_factors/quad_rays.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/sobol.h"
#include "pipeline/system/vector_code.h"

namespace patchlight {

namespace {

/// Sine and cosine of 2 pi `turns`, for `turns` in [0,1], within 3e-7; loops over it are vectorised.
inline void sin_cos_of_turns(float turns, float& sine, float& cosine) {
  const int quarter = int(4.0f * turns + 0.5f);
  const float a = float(2 * kPi) * (turns - 0.25f * float(quarter)), b = a * a;
  const float s = a * (1.0f + b * (-1.0f / 6 + b * (1.0f / 120 - b * (1.0f / 5040))));
  const float c = 1.0f + b * (-0.5f + b * (1.0f / 24 + b * (-1.0f / 720 + b * (1.0f / 40320))));
  const bool odd = quarter & 1;
  const float x = odd ? c : s, y = odd ? s : c;
  sine = quarter & 2 ? -x : x;
  cosine = (quarter + 1) & 2 ? -y : y;
}

/// Inverts the distribution whose density is linear from a to b over [0,1] (Pharr et al. 2023, section A.5.1).
inline float sample_linear(float x, float a, float b) {
  constexpr float kTiny = 1e-30f;
  return std::min(x * (a + b) / (a + std::sqrt((1.0f - x) * a * a + x * b * b) + kTiny), 1.0f);
}

}  // namespace

QuadPatch make_quad_patch(const RayScene& ray_scene, const Primitive& primitive, const Patch& patch, float offset) {
  const auto corner_at = [&](float u, float v) { return ray_scene.to_local(point_at(primitive, u, v).position); };
  const Vec3f c00 = corner_at(patch.u0, patch.v0), c10 = corner_at(patch.u1, patch.v0);
  const Vec3f c01 = corner_at(patch.u0, patch.v1), c11 = corner_at(patch.u1, patch.v1);
  const Vec3f u0 = c10 - c00, v0 = c01 - c00, u1 = c11 - c01, v1 = c11 - c10;
  Vec3f tangent, bitangent;
  orthonormal_frame(patch.normal, tangent, bitangent);
  return {c00 + patch.normal * offset,
          u0,
          v0,
          u1 - u0,
          tangent,
          bitangent,
          patch.normal,
          {(u0 % v0).length(), (u0 % v1).length(), (u1 % v0).length(), (u1 % v1).length()}};
}

VECTOR_CODE void shift_samples(const DirectionTable& table, int first, const std::array<std::uint32_t, 4>& shift,
                               QuadSamples& samples) {
  const std::uint32_t *x = table.x.data() + first, *y = table.y.data() + first;
  const std::uint32_t *u = table.u.data() + first, *v = table.v.data() + first;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const float square = unit_float(x[lane] ^ shift[0]);
    float sine, cosine;
    sin_cos_of_turns(unit_float(y[lane] ^ shift[1]), sine, cosine);
    const float radius = std::sqrt(square);
    samples.dx[lane] = radius * cosine;
    samples.dy[lane] = radius * sine;
    samples.dz[lane] = std::sqrt(1.0f - square);
    samples.u[lane] = unit_float(u[lane] ^ shift[2]);
    samples.v[lane] = unit_float(v[lane] ^ shift[3]);
  }
}

VECTOR_CODE void set_quad_rays(const QuadPatch& patch, QuadSamples& samples, RayPacket& packet) {
  const auto& d = patch.density;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const float v = sample_linear(samples.v[lane], d[0] + d[1], d[2] + d[3]);
    samples.u[lane] = sample_linear(samples.u[lane], d[0] * (1.0f - v) + d[2] * v, d[1] * (1.0f - v) + d[3] * v);
    samples.v[lane] = v;
  }
  auto& ray = packet.rays.ray;
  float* const origins[] = {ray.org_x, ray.org_y, ray.org_z};
  float* const directions[] = {ray.dir_x, ray.dir_y, ray.dir_z};
  for (int k = 0; k < 3; ++k) {
    const float c = patch.corner[k], along_u = patch.along_u[k], along_v = patch.along_v[k], twist = patch.twist[k];
    const float t = patch.tangent[k], b = patch.bitangent[k], n = patch.normal[k];
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      origins[k][lane] = c + samples.u[lane] * (along_u + samples.v[lane] * twist) + samples.v[lane] * along_v;
      directions[k][lane] = t * samples.dx[lane] + b * samples.dy[lane] + n * samples.dz[lane];
    }
  }
}

}  // namespace patchlight
