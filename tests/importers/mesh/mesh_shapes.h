#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "importers/mesh/surface.h"

namespace patchlight::test {

/// Vertices and triangles, counter-clockwise from outside.
struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;
  std::vector<Vec3f> normals;
};

inline Mesh inverted(Mesh mesh) {
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i], mesh.indices[i + 1]);
  return mesh;
}

inline Mesh scaled(Mesh mesh, const Vec3f& scale) {
  for (Vec3f& p : mesh.positions) p *= scale;
  return mesh;
}

/// Only the first triangles.
inline Mesh truncated(Mesh mesh, std::size_t triangles) {
  mesh.indices.resize(triangles * 3);
  return mesh;
}

/// Corners in order, split along the diagonal from corner 0.
inline Mesh quad_mesh(const std::array<Vec3f, 4>& corners) {
  return {{corners.begin(), corners.end()}, {0, 1, 2, 0, 2, 3}, {}};
}

/// From -1 to 1.
inline Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f);
  mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return mesh;
}

/// n x n unit squares in the plane z = 0, facing +Z.
inline Mesh grid(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) mesh.positions.emplace_back(float(x), float(y), 0.0f);
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 2, d = a + n + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
    }
  return mesh;
}

/// The square from -1 to 1 in the plane z = 0, facing +Z, less a regular polygon of 8 n corners about its middle.
inline Mesh plate_with_hole(std::uint32_t n, double radius) {
  Mesh mesh;
  const std::uint32_t corners = 8 * n;
  for (std::uint32_t k = 0; k < corners; ++k) {
    const double angle = 2 * kPi * k / corners, x = std::cos(angle), y = std::sin(angle);
    const double outwards = 1 / std::max(std::abs(x), std::abs(y));
    mesh.positions.emplace_back(Vec3d(x * outwards, y * outwards, 0));
    mesh.positions.emplace_back(Vec3d(x * radius, y * radius, 0));
  }
  for (std::uint32_t k = 0; k < corners; ++k) {
    const std::uint32_t a = 2 * k, b = a + 1, c = 2 * ((k + 1) % corners), d = c + 1;
    mesh.indices.insert(mesh.indices.end(), {a, c, b, b, c, d});
  }
  return mesh;
}

/// Like Blender's: radius 1, poles on the Y axis.
inline Mesh uv_sphere(std::uint32_t segments, std::uint32_t rings) {
  Mesh mesh;
  mesh.positions.emplace_back(0.0f, 1.0f, 0.0f);
  for (std::uint32_t r = 1; r < rings; ++r)
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double theta = kPi * r / rings, phi = 2 * kPi * s / segments;
      mesh.positions.emplace_back(
          Vec3d(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)));
    }
  mesh.positions.emplace_back(0.0f, -1.0f, 0.0f);
  const auto last = std::uint32_t(mesh.positions.size() - 1);
  const auto at = [&](std::uint32_t r, std::uint32_t s) { return 1 + (r - 1) * segments + s % segments; };
  for (std::uint32_t s = 0; s < segments; ++s) {
    mesh.indices.insert(mesh.indices.end(), {0, at(1, s), at(1, s + 1)});
    for (std::uint32_t r = 1; r + 1 < rings; ++r)
      mesh.indices.insert(mesh.indices.end(),
                          {at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    mesh.indices.insert(mesh.indices.end(), {at(rings - 1, s), last, at(rings - 1, s + 1)});
  }
  return mesh;
}

/// 20 x 4^divisions faces, radius 1.
inline Mesh icosphere(int divisions) {
  const float g = 1.618034f;
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3f& p : mesh.positions) p = Vec3f(Vec3d(p).normalized());
  mesh.indices = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
                  3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
  for (int division = 0; division < divisions; ++division) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] = middles.emplace(std::minmax(a, b), std::uint32_t(mesh.positions.size()));
      if (is_new) mesh.positions.emplace_back((Vec3d(mesh.positions[a]) + Vec3d(mesh.positions[b])).normalized());
      return entry->second;
    };
    std::vector<std::uint32_t> fine;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const std::uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      fine.insert(fine.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
    }
    mesh.indices = fine;
  }
  return mesh;
}

inline TriangleSoup soup_of(const Mesh& mesh) {
  TriangleSoup soup;
  for (const std::uint32_t index : mesh.indices) {
    soup.positions.emplace_back(mesh.positions[index]);
    soup.normals.push_back(mesh.normals.empty() ? Vec3f(0.0f) : mesh.normals[index]);
  }
  return soup;
}

}  // namespace patchlight::test
