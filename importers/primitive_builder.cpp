#include "importers/primitive_builder.h"

#include <algorithm>
#include <cmath>

#include "importers/mesh_topology.h"
#include "importers/quad_recognition.h"
#include "importers/sphere_recognition.h"

namespace patchlight {
namespace {

Primitive blank_primitive(const Surface& surface) {
  Primitive primitive;
  primitive.node = surface.node;
  primitive.material = surface.material;
  primitive.light_group = surface.light_group;
  primitive.shader = surface.shader;
  return primitive;
}

/// Which corners of the front a back's corners are: seen from there they run the other way.
std::array<std::size_t, 4> corners_of_back(const Primitive& front) {
  return front.is_triangle() ? std::array<std::size_t, 4>{1, 0, 2, 2} : std::array<std::size_t, 4>{1, 0, 3, 2};
}

/// The other side; its u is mirrored.
Primitive other_side(const Primitive& front, std::int32_t smooth_offset) {
  Primitive back = front;
  back.sphere_radius = -front.sphere_radius;
  if (front.shape == Primitive::Shape::sphere) return back;
  const std::array<std::size_t, 4> order = corners_of_back(front);
  for (std::size_t i = 0; i < 4; ++i) {
    back.corners[i] = front.corners[order[i]];
    back.smooth_vertices[i] = front.smooth_vertices[order[i]] + smooth_offset;
  }
  return back;
}

void append(const Primitive& front, bool double_sided, std::int32_t smooth_offset, PrimitiveList& list) {
  const auto index = static_cast<std::int32_t>(list.primitives.size());
  list.primitives.push_back(front);
  if (!double_sided) return;
  list.primitives.push_back(other_side(front, smooth_offset));
  list.primitives[index].back = index + 1;
  list.primitives[index + 1].back = index;
}

/// Notes the texture coordinates of the primitive appended last, and of its back: the same at the same place.
void append_texcoords(const Texcoords& front, PrimitiveList& list) {
  const Primitive& last = list.primitives.back();
  const bool two = last.back >= 0;
  list.texcoords.resize(list.primitives.size() - (two ? 2 : 1), kOwnTexcoords);
  list.texcoords.push_back(front);
  if (!two) return;
  const std::array<std::size_t, 4> order = corners_of_back(list.primitives[last.back]);
  list.texcoords.push_back({front[order[0]], front[order[1]], front[order[2]], front[order[3]]});
}

bool has_texcoords(const MeshTopology& topology, const MeshTopology::Component& component) {
  if (topology.texcoords.empty()) return false;
  return !std::isnan(topology.texcoords[3 * static_cast<std::size_t>(component.triangles.front())].x);
}

/// Numbers the facets' smooth vertices from 0 without gaps. Returns how many there are.
std::int32_t renumber_smooth_vertices(std::vector<Facet>& facets, std::size_t corners) {
  std::vector<std::int32_t> number(corners, -1);
  std::int32_t count = 0;
  for (Facet& facet : facets) {
    for (std::int32_t& id : facet.smooth_vertices) {
      if (number[id] < 0) number[id] = count++;
      id = number[id];
    }
  }
  return count;
}

}  // namespace

void append_primitives(const Surface& surface, const SurfaceMaterial& material, const TriangleSoup& soup,
                       PrimitiveList& list) {
  const MeshTopology topology = build_topology(soup);
  list.without_area += static_cast<std::int64_t>(topology.without_area);

  std::vector<char> in_sphere(topology.triangles.size(), 0);
  for (const MeshTopology::Component& component : topology.components) {
    if (material.texture >= 0 && has_texcoords(topology, component)) continue;  // no (u,v) of a sphere is like them
    const std::optional<Sphere> sphere = recognize_sphere(topology, component);
    if (!sphere) continue;
    for (const std::int32_t triangle : component.triangles) in_sphere[triangle] = 1;
    Primitive primitive = blank_primitive(surface);
    primitive.shape = Primitive::Shape::sphere;
    primitive.sphere_center = sphere->center;
    primitive.sphere_radius = sphere->radius;
    append(primitive, material.double_sided, 0, list);
    ++list.spheres;
  }

  std::vector<Facet> facets = recognize_quads(topology, in_sphere);
  const std::int32_t smooth_count = renumber_smooth_vertices(facets, topology.triangles.size() * 3);
  for (const Facet& facet : facets) {
    Primitive primitive = blank_primitive(surface);
    primitive.corners = facet.corners;
    for (std::size_t i = 0; i < 4; ++i) primitive.smooth_vertices[i] = facet.smooth_vertices[i] + list.smooth_vertices;
    append(primitive, material.double_sided, smooth_count, list);
    if (!topology.texcoords.empty() && !std::isnan(facet.texcoords[0].x)) {
      append_texcoords(facet.texcoords, list);
      for (std::size_t i = list.primitives.size() - (material.double_sided ? 2 : 1); i < list.primitives.size(); ++i)
        list.primitives[i].texture = material.texture;
    }
    ++(primitive.is_triangle() ? list.triangles : list.quads);
  }
  list.smooth_vertices += material.double_sided ? 2 * smooth_count : smooth_count;
}

}  // namespace patchlight
