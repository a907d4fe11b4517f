#include "importers/mesh/sphere_recognition.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

constexpr double kVertexTolerance = 1e-4;  // distance from the sphere / radius
constexpr double kMinCoverage = 0.7;       // area of the facets / area of the sphere
constexpr double kMaxCoverage = 1.01;
constexpr double kRadialCosine = 0.9877;  // of shading normals to the radius

std::vector<Vec3d> distinct_vertices(const MeshTopology& topology, const MeshTopology::Component& component) {
  std::vector<std::int32_t> numbers;
  for (const std::int32_t triangle : component.triangles) {
    const auto& vertices = topology.triangles[triangle].vertices;
    numbers.insert(numbers.end(), vertices.begin(), vertices.end());
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  std::vector<Vec3d> vertices;
  for (const std::int32_t number : numbers) vertices.push_back(topology.vertices[number]);
  return vertices;
}

/// Least-squares sphere: minimises the sum of (|p - c|^2 - R^2)^2, which is linear in c about the vertices' mean.
std::optional<Sphere> fitted_sphere(const std::vector<Vec3d>& vertices) {
  Vec3d mean(0.0);
  for (const Vec3d& p : vertices) mean += p;
  mean /= static_cast<double>(vertices.size());
  Imath::M33d matrix;
  matrix.makeIdentity();
  for (int i = 0; i < 3; ++i) matrix[i][i] = 0.0;
  Vec3d rhs(0.0);
  double extent = 0.0;
  for (const Vec3d& p : vertices) extent = std::max(extent, (p - mean).length());
  if (!(extent > 0.0)) return std::nullopt;
  for (const Vec3d& p : vertices) {
    const Vec3d d = (p - mean) / extent;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) matrix[i][j] += d[i] * d[j];
    }
    rhs += d * (0.5 * d.length2());
  }
  const auto count = static_cast<double>(vertices.size());
  matrix *= 1.0 / count;
  rhs /= count;
  if (!(std::abs(matrix.determinant()) > 1e-9)) return std::nullopt;  // coplanar vertices
  Sphere sphere;
  sphere.center = mean + extent * (rhs * matrix.inverse());
  for (const Vec3d& p : vertices) sphere.radius += (p - sphere.center).length() / count;
  return sphere;
}

}  // namespace

std::optional<Sphere> recognize_sphere(const MeshTopology& topology, const MeshTopology::Component& component) {
  if (!component.closed) return std::nullopt;
  const std::vector<Vec3d> vertices = distinct_vertices(topology, component);
  std::optional<Sphere> sphere = fitted_sphere(vertices);
  if (!sphere) return std::nullopt;
  const double radius = sphere->radius;
  for (const Vec3d& p : vertices) {
    if (!(std::abs((p - sphere->center).length() - radius) <= kVertexTolerance * radius + topology.rounding))
      return std::nullopt;
  }

  double area = 0.0;
  std::size_t outward = 0;
  for (const std::int32_t number : component.triangles) {
    const MeshTopology::Triangle& triangle = topology.triangles[number];
    const double height = triangle.normal.dot(topology.vertices[triangle.vertices[0]] - sphere->center);
    if (!(std::abs(height) >= (1.0 - kMaxSagitta) * radius)) return std::nullopt;
    if (height > 0.0) ++outward;
    area += triangle.area;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d radial = (topology.vertices[triangle.vertices[i]] - sphere->center).normalized();
      const Vec3d of_file(topology.normals[3 * static_cast<std::size_t>(number) + i]);
      const Vec3d& normal = of_file == Vec3d(0.0) ? triangle.normal : of_file;
      if (!(std::abs(normal.dot(radial)) >= kRadialCosine)) return std::nullopt;
    }
  }
  if (outward != 0 && outward != component.triangles.size()) return std::nullopt;
  const double coverage = area / (4.0 * kPi * radius * radius);
  if (coverage < kMinCoverage || coverage > kMaxCoverage) return std::nullopt;
  if (outward == 0) sphere->radius = -radius;
  return sphere;
}

}  // namespace patchlight
