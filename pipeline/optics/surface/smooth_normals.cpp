#include "pipeline/optics/surface/smooth_normals.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

constexpr float kSameNormal = 0.999999f;  // cosine above which two normals are the same

/// Interior angle at a corner.
double corner_angle(const Primitive& p, int k) {
  const int count = p.is_triangle() ? 3 : 4;
  const Vec3d a = p.corners[(k + 1) % count] - p.corners[k], b = p.corners[(k + count - 1) % count] - p.corners[k];
  return std::atan2((a % b).length(), a ^ b);
}

}  // namespace

SmoothNormals::SmoothNormals(const PatchSet& scene) : corner_index_(scene.primitives.size(), -1) {
  std::int32_t vertices = 0;
  for (const Primitive& p : scene.primitives)
    vertices = std::max(vertices, *std::max_element(p.smooth_vertices.begin(), p.smooth_vertices.end()) + 1);
  std::vector<Vec3d> sums(std::size_t(vertices), Vec3d(0.0));
  for (const Primitive& p : scene.primitives) {
    if (p.smooth_vertices[0] < 0) continue;
    const Vec3d normal(point_at(p, 0.5, 0.5).normal);
    for (int k = 0; k < (p.is_triangle() ? 3 : 4); ++k) sums[p.smooth_vertices[k]] += normal * corner_angle(p, k);
  }
  for (std::size_t i = 0; i < corner_index_.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.smooth_vertices[0] < 0) continue;
    const Vec3f flat = point_at(p, 0.5, 0.5).normal;
    std::array<Vec3f, 4> corners;
    bool curved = false;
    for (int k = 0; k < 4; ++k) {
      const Vec3d& sum = sums[p.smooth_vertices[k]];
      corners[k] = sum.length() > 0 ? Vec3f(sum.normalized()) : flat;
      curved = curved || (corners[k] ^ flat) < kSameNormal;
    }
    if (!curved) continue;
    corner_index_[i] = std::int32_t(corners_.size());
    corners_.push_back(corners);
  }
}

Vec3f SmoothNormals::operator()(std::int32_t i, float u, float v, const Vec3f& flat) const {
  if (corner_index_[i] < 0) return flat;
  const auto& c = corners_[corner_index_[i]];
  const Vec3f normal = (c[0] * (1 - u) + c[1] * u) * (1 - v) + (c[3] * (1 - u) + c[2] * u) * v;
  const float length = normal.length();
  return length > 0 ? normal / length : flat;
}

}  // namespace patchlight
