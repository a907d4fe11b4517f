#include "importers/patches/patch_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/model/cuts/region_shape.h"

namespace patchlight {
namespace {

constexpr int kMinRings = 2;
constexpr int kMinPatchesPerRing = 3;
constexpr double kMaxPatchesPerRow = 1 << 22;  // boundaries are floats and must differ
constexpr double kLeastPart = 1e-4;            // of a cell that counts, over the mean part that lies in the region
constexpr double kPlanar =
    1e-7;  // distance of a corner from the plane / diagonal; the relative area error is its square

using Corners = std::array<Vec3d, 4>;

double sphere_rings(const Primitive& sphere, double patch_area) {
  const double radius = std::abs(sphere.sphere_radius);
  return std::max<double>(kMinRings, std::round(kPi * radius / std::sqrt(patch_area)));
}

double patches_in_ring(const Primitive& sphere, double patch_area, double ring, double rings) {
  const double circumference = 2.0 * kPi * std::abs(sphere.sphere_radius) * std::sin(kPi * (ring + 0.5) / rings);
  return std::max<double>(kMinPatchesPerRing, std::round(circumference / std::sqrt(patch_area)));
}

/// Boundary i of a grid of `count` cells, identical to the bit in both neighbours.
float boundary(std::int64_t i, std::int64_t count) {
  return static_cast<float>(static_cast<double>(i) / static_cast<double>(count));
}

Vec3d quad_point(const Corners& c, double u, double v) {
  return (c[0] * (1 - u) + c[1] * u) * (1 - v) + (c[3] * (1 - u) + c[2] * u) * v;
}

/// dp/du x dp/dv: the unnormalised normal; its length is the area per du dv.
Vec3d quad_area_vector(const Corners& c, double u, double v) {
  const Vec3d along_u = (c[1] - c[0]) * (1 - v) + (c[2] - c[3]) * v;
  const Vec3d along_v = (c[3] - c[0]) * (1 - u) + (c[2] - c[1]) * u;
  return along_u.cross(along_v);
}

bool is_planar(const Corners& c) {
  const Vec3d normal = (c[2] - c[0]).cross(c[3] - c[1]).normalized();
  const double length = std::max((c[2] - c[0]).length(), (c[3] - c[1]).length());
  return std::abs(normal.dot(c[1] - c[0])) <= kPlanar * length && std::abs(normal.dot(c[3] - c[0])) <= kPlanar * length;
}

/// Area of a (u,v) rectangle of the bilinear surface. On a planar quad the area per du dv is linear in u and v, so the
/// midpoint rule is exact; otherwise 3 x 3 Gauss-Legendre quadrature.
double quad_area(const Corners& c, bool planar, double u0, double v0, double u1, double v1) {
  const double u = (u0 + u1) * 0.5;
  const double v = (v0 + v1) * 0.5;
  const double size = (u1 - u0) * (v1 - v0);
  if (planar) return quad_area_vector(c, u, v).length() * size;
  constexpr std::array nodes{-0.774596669241483377, 0.0, 0.774596669241483377};
  constexpr std::array weights{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3d area_vector = quad_area_vector(c, u + nodes[i] * (u1 - u0) * 0.5, v + nodes[j] * (v1 - v0) * 0.5);
      sum += weights[i] * weights[j] * area_vector.length();
    }
  }
  return sum * size;
}

/// Calls act(patch) for each cell of a grid on a region: what of it lies there as a patch.
template <class Act>
void for_each_cell_in_region(const Primitive& primitive, Patch cell, const QuadGrid& grid, Act act) {
  const PlaneFrame frame = *PlaneFrame::of(primitive);
  const RegionShape shape(primitive, frame);
  const double least =
      kLeastPart * primitive_area(primitive) / (static_cast<double>(grid.columns) * static_cast<double>(grid.rows));
  cell.normal = Vec3f(frame.normal());
  for (std::int64_t row = 0; row < grid.rows; ++row)
    for (std::int64_t column = 0; column < grid.columns; ++column) {
      cell.u0 = boundary(column, grid.columns);
      cell.u1 = boundary(column + 1, grid.columns);
      cell.v0 = boundary(row, grid.rows);
      cell.v1 = boundary(row + 1, grid.rows);
      const Polygon polygon = cell_polygon(primitive, frame, cell);
      const std::vector<Polygon> parts = shape.inside(polygon);
      const bool is_whole = fill(parts, polygon);
      set_part(is_whole ? std::vector<Polygon>{polygon} : parts, frame, cell);
      if (is_whole) cell.triangles.clear();
      if (cell.area > least) act(cell);
    }
}

/// A patch with the values common to all patches of a primitive; (u,v), centre, normal and area are not set.
Patch patch_template(std::int32_t index, const SurfaceMaterial& material) {
  Patch patch;
  patch.reflectance = material.reflectance;
  patch.emission = material.emission;
  patch.primitive = index;
  return patch;
}

void append_quad(const Primitive& quad, Patch patch, const QuadGrid& grid, std::vector<Patch>& patches) {
  const Corners& c = quad.corners;
  const std::int64_t columns = grid.columns, rows = grid.rows;
  const bool planar = is_planar(c);
  const Vec3f normal((c[2] - c[0]).cross(c[3] - c[1]).normalized());
  for (std::int64_t row = 0; row < rows; ++row) {
    patch.v0 = boundary(row, rows);
    patch.v1 = boundary(row + 1, rows);
    for (std::int64_t column = 0; column < columns; ++column) {
      patch.u0 = boundary(column, columns);
      patch.u1 = boundary(column + 1, columns);
      const double u = (static_cast<double>(patch.u0) + patch.u1) * 0.5;
      const double v = (static_cast<double>(patch.v0) + patch.v1) * 0.5;
      patch.center = quad_point(c, u, v);
      patch.normal = planar ? normal : Vec3f(quad_area_vector(c, u, v).normalized());
      patch.area = quad_area(c, planar, patch.u0, patch.v0, patch.u1, patch.v1);
      patches.push_back(patch);
    }
  }
}

void append_region(const Primitive& primitive, const Patch& patch, const QuadGrid& grid, std::vector<Patch>& patches) {
  for_each_cell_in_region(primitive, patch, grid, [&](const Patch& cell) { patches.push_back(cell); });
}

void append_sphere(const Primitive& sphere, Patch patch, double patch_area, std::vector<Patch>& patches) {
  const double radius = std::abs(sphere.sphere_radius);
  const double side = sphere.sphere_radius < 0.0 ? -1.0 : 1.0;
  const auto rings = static_cast<std::int64_t>(sphere_rings(sphere, patch_area));
  for (std::int64_t ring = 0; ring < rings; ++ring) {
    const auto columns = static_cast<std::int64_t>(
        patches_in_ring(sphere, patch_area, static_cast<double>(ring), static_cast<double>(rings)));
    patch.v0 = boundary(ring, rings);
    patch.v1 = boundary(ring + 1, rings);
    const double middle = kPi * (static_cast<double>(patch.v0) + patch.v1) * 0.5;
    const double half = kPi * (static_cast<double>(patch.v1) - patch.v0) * 0.5;
    const double height = 2.0 * std::sin(middle) * std::sin(half);  // cos(theta1) - cos(theta2), without cancellation
    for (std::int64_t column = 0; column < columns; ++column) {
      patch.u0 = boundary(column, columns);
      patch.u1 = boundary(column + 1, columns);
      const double azimuth = kPi * (static_cast<double>(patch.u0) + patch.u1);
      const Vec3d out(std::sin(middle) * std::cos(azimuth), std::cos(middle), -std::sin(middle) * std::sin(azimuth));
      patch.center = sphere.sphere_center + out * radius;
      patch.normal = Vec3f(out * side);
      patch.area = radius * radius * 2.0 * kPi * (static_cast<double>(patch.u1) - patch.u0) * height;
      patches.push_back(patch);
    }
  }
}

}  // namespace

double primitive_area(const Primitive& primitive) {
  if (primitive.shape == Primitive::Shape::sphere) return 4.0 * kPi * primitive.sphere_radius * primitive.sphere_radius;
  const double whole = quad_area(primitive.corners, is_planar(primitive.corners), 0.0, 0.0, 1.0, 1.0);
  return primitive.region ? whole * primitive.region->area() : whole;
}

QuadGrid quad_grid(const Primitive& quad, double patch_area) {
  const Corners& c = quad.corners;
  if (quad.is_triangle() && primitive_area(quad) < 2.0 * patch_area) return {};
  const double step = std::sqrt(patch_area);
  const double u_length = ((c[1] - c[0]).length() + (c[2] - c[3]).length()) * 0.5;
  const double v_length = ((c[3] - c[0]).length() + (c[2] - c[1]).length()) * 0.5;
  const auto cells = [](double count) {
    return static_cast<std::int32_t>(std::clamp(std::round(count), 1.0, kMaxPatchesPerRow));
  };
  const double most = quad.region ? double(Region::kMostCells) : std::numeric_limits<double>::infinity();
  const double coarser = std::max(1.0, std::sqrt(u_length * v_length / (patch_area * most)));
  return {cells(u_length / (step * coarser)), cells(v_length / (step * coarser))};
}

double patch_count(const Primitive& primitive, double patch_area) {
  if (primitive.shape == Primitive::Shape::quad) {
    const QuadGrid grid = quad_grid(primitive, patch_area);
    const double cells = static_cast<double>(grid.columns) * grid.rows;
    if (!primitive.region || cells == 1.0) return cells;
    double count = 0.0;
    for_each_cell_in_region(primitive, {}, grid, [&](const Patch&) { ++count; });
    return count;
  }
  const double rings = sphere_rings(primitive, patch_area);
  if (rings > 1e5)
    return primitive_area(primitive) / patch_area;  // too many to count ring by ring, and above every limit
  double count = 0.0;
  for (double ring = 0.0; ring < rings; ++ring) count += patches_in_ring(primitive, patch_area, ring, rings);
  return count;
}

void append_patches(const Primitive& primitive, std::int32_t index, const SurfaceMaterial& material,
                    const PatchTarget& target, std::vector<Patch>& patches) {
  const Patch common = patch_template(index, material);
  if (primitive.shape == Primitive::Shape::sphere) {
    append_sphere(primitive, common, target.area, patches);
    return;
  }
  const QuadGrid grid = target.grid.columns > 0 ? target.grid : quad_grid(primitive, target.area);
  if (primitive.region)
    append_region(primitive, common, grid, patches);
  else
    append_quad(primitive, common, grid, patches);
}

}  // namespace patchlight
