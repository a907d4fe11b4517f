#include "importers/patches/primitive_builder.h"

#include <algorithm>
#include <cmath>

#include "importers/mesh/mesh_topology.h"
#include "importers/mesh/quad_recognition.h"
#include "importers/mesh/sphere_recognition.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {
namespace {

constexpr float kSameColor = 1.0f / 512;
constexpr float kSameNormal = 0.999999f;  // cosine above which two normals are the same

Primitive primitive_template(const Surface& surface) {
  Primitive primitive;
  primitive.node = surface.node;
  primitive.material = surface.material;
  primitive.light_group = surface.light_group;
  primitive.shader = surface.shader;
  return primitive;
}

/// The back of a double-sided primitive; its u is mirrored.
Primitive back_of(const Primitive& front, std::int32_t smooth_offset) {
  Primitive back = front;
  back.sphere_radius = -front.sphere_radius;
  if (front.shape == Primitive::Shape::sphere) return back;
  const std::array<std::size_t, 4> order = reversed_corners(front);
  for (std::size_t i = 0; i < 4; ++i) {
    back.corners[i] = front.corners[order[i]];
    back.smooth_vertices[i] = front.smooth_vertices[order[i]] + smooth_offset;
  }
  if (front.region) back.region = std::make_shared<const Region>(front.region->mirrored());
  return back;
}

void append(const Primitive& front, bool double_sided, std::int32_t smooth_offset, PrimitiveList& list) {
  const auto index = static_cast<std::int32_t>(list.primitives.size());
  list.primitives.push_back(front);
  if (!double_sided) return;
  list.primitives.push_back(back_of(front, smooth_offset));
  list.primitives[index].back = index + 1;
  list.primitives[index + 1].back = index;
}

/// Sets the corner values of the primitive appended last, and of its back. Primitives before it without values get
/// `none`.
template <class Value>
void append_corners(const std::array<Value, 4>& front, const std::array<Value, 4>& none, const PrimitiveList& list,
                    std::vector<std::array<Value, 4>>& corners) {
  const Primitive& last = list.primitives.back();
  const bool double_sided = last.back >= 0;
  corners.resize(list.primitives.size() - (double_sided ? 2 : 1), none);
  corners.push_back(front);
  if (!double_sided) return;
  const std::array<std::size_t, 4> order = reversed_corners(list.primitives[last.back]);
  corners.push_back({front[order[0]], front[order[1]], front[order[2]], front[order[3]]});
}

/// Sets the shading normals of the primitive appended last, and of its back, if they are not the surface's own.
void append_normals(std::array<Vec3f, 4> normals, PrimitiveList& list) {
  const Primitive& last = list.primitives.back();
  const bool double_sided = last.back >= 0;
  const Primitive& front = double_sided ? list.primitives[last.back] : last;
  const Vec3f flat = point_at(front, 0.5, 0.5).normal;
  bool curved = false;
  for (Vec3f& n : normals) {
    if (!(n.normalize().dot(flat) > 0.0f)) return;
    curved = curved || n.dot(flat) < kSameNormal;
  }
  if (!curved) return;
  append_corners(normals, kFlatNormals, list, list.normals);
  if (double_sided)
    for (Vec3f& n : list.normals.back()) n = -n;
}

bool has_texcoords(const MeshTopology& topology, const MeshTopology::Component& component) {
  const std::size_t corner = 3 * static_cast<std::size_t>(component.triangles.front());
  return std::any_of(topology.texcoords.begin(), topology.texcoords.end(),
                     [&](const auto& texcoords) { return !std::isnan(texcoords[corner].x); });
}

/// Whether all corners of a component have the same colour, which a sphere requires.
bool has_one_color(const MeshTopology& topology, const MeshTopology::Component& component) {
  if (topology.colors.empty()) return true;
  const Vec4f& color = topology.colors[3 * static_cast<std::size_t>(component.triangles.front())];
  return std::all_of(component.triangles.begin(), component.triangles.end(), [&](std::int32_t triangle) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec4f difference = topology.colors[3 * static_cast<std::size_t>(triangle) + i] - color;
      if (!(difference.length() <= kSameColor)) return false;
    }
    return true;
  });
}

/// Volume of a closed component, positive if it looks outwards, m3.
double volume(const MeshTopology& topology, const MeshTopology::Component& component) {
  const auto at = [&](std::int32_t triangle, std::size_t k) {
    return topology.vertices[topology.triangles[triangle].vertices[k]];
  };
  const Vec3d origin = at(component.triangles.front(), 0);
  double sum = 0;
  for (const std::int32_t t : component.triangles)
    sum += ((at(t, 0) - origin) ^ ((at(t, 1) - origin) % (at(t, 2) - origin))) / 6;
  return sum;
}

/// Whether all parts of a mesh are closed and look outwards.
bool is_body(const MeshTopology& topology) {
  return std::ranges::all_of(topology.components, [&](const MeshTopology::Component& component) {
    return component.closed && volume(topology, component) > 0;
  });
}

/// Renumbers the facets' smooth vertices consecutively from 0. Returns their number.
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

/// Appends the spheres among a surface's components. Returns a mark for each triangle of these.
std::vector<char> append_spheres(const Surface& surface, const SurfaceMaterial& material, const MeshTopology& topology,
                                 bool two_sides, PrimitiveList& list) {
  std::vector<char> in_sphere(topology.triangles.size(), 0);
  if (surface.is_masked) return in_sphere;  // the mask's texture coordinates do not fit a sphere's (u,v)
  for (const MeshTopology::Component& component : topology.components) {
    // The file's texture coordinates do not fit a sphere's (u,v).
    if (material.has_texture() && has_texcoords(topology, component)) continue;
    const std::optional<Sphere> sphere = recognize_sphere(topology, component);
    if (!sphere || !has_one_color(topology, component)) continue;
    for (const std::int32_t triangle : component.triangles) in_sphere[triangle] = 1;
    Primitive primitive = primitive_template(surface);
    primitive.shape = Primitive::Shape::sphere;
    primitive.sphere_center = sphere->center;
    primitive.sphere_radius = sphere->radius;
    append(primitive, two_sides, 0, list);
    if (!topology.colors.empty()) {
      CornerColors colors;
      colors.fill(topology.colors[3 * static_cast<std::size_t>(component.triangles.front())]);
      append_corners(colors, kWhiteVertices, list, list.colors);
    }
    ++list.spheres;
  }
  return in_sphere;
}

}  // namespace

std::array<std::size_t, 4> reversed_corners(const Primitive& front) {
  return front.is_triangle() ? std::array<std::size_t, 4>{1, 0, 2, 2} : std::array<std::size_t, 4>{1, 0, 3, 2};
}

void append_primitives(const Surface& surface, const SurfaceMaterial& material, const TriangleSoup& soup,
                       const std::function<bool()>& is_dark_inside, PrimitiveList& list) {
  const MeshTopology topology = build_topology(soup);
  list.degenerate_triangles += static_cast<std::int64_t>(topology.degenerate_triangles);
  list.added_triangles += static_cast<std::int64_t>(topology.added_triangles);
  list.invalid_normals += soup.invalid_normals + static_cast<std::int64_t>(topology.normals_behind);
  const bool two_sides = material.has_two_sides() && !(is_body(topology) && is_dark_inside());
  std::vector<char> in_sphere = append_spheres(surface, material, topology, two_sides, list);
  // Lamps and mirrors are sampled by their corners, and masks have their own texture coordinates.
  const bool as_regions = surface.light_group < 0 && material.specular == Color(0.0f) &&
                          material.metal == Color(0.0f) && !surface.is_masked;
  RecognizedFacets recognized = recognize_quads(topology, std::move(in_sphere), as_regions);
  std::vector<Facet>& facets = recognized.facets;
  list.merged_triangles += static_cast<std::int64_t>(recognized.merged_triangles);
  list.merged_facets += static_cast<std::int64_t>(recognized.merged_facets);
  const std::int32_t smooth_count =
      renumber_smooth_vertices(facets, static_cast<std::size_t>(recognized.smooth_vertices));
  const SurfaceMaterial::Mappings mappings = material.mappings();
  for (const Facet& facet : facets) {
    Primitive primitive = primitive_template(surface);
    primitive.corners = facet.corners;
    primitive.region = facet.region;
    for (std::size_t i = 0; i < 4; ++i) primitive.smooth_vertices[i] = facet.smooth_vertices[i] + list.smooth_vertices;
    const auto has_mapping = [&](std::size_t mapping) {
      return !topology.texcoords.empty() && !std::isnan(facet.sources[0](topology.texcoords[mapping]).x);
    };
    if (has_mapping(0)) primitive.texture = material.texture;
    if (has_mapping(mappings.emission)) primitive.emission_texture = material.emission_texture;
    if (has_mapping(mappings.metallic_roughness))
      primitive.metallic_roughness_texture = material.metallic_roughness_texture;
    if (has_mapping(mappings.normal)) primitive.normal_texture = material.normal_texture;
    if (surface.is_masked && (has_mapping(0) || material.masked_by_vertices_only || material.has_uniform_mask))
      primitive.mask = material.mask;
    append(primitive, two_sides, smooth_count, list);
    const auto at_corners = [&](const auto& values) {
      const auto& s = facet.sources;
      return std::array{s[0](values), s[1](values), s[2](values), s[3](values)};
    };
    if (has_mapping(0)) append_corners(at_corners(topology.texcoords[0]), kIdentityTexcoords, list, list.texcoords);
    for (const auto& [mapping, corners] : {std::pair(mappings.emission, &list.emission_texcoords),
                                           std::pair(mappings.metallic_roughness, &list.metallic_roughness_texcoords),
                                           std::pair(mappings.normal, &list.normal_texcoords)})
      if (mapping > 0 && has_mapping(mapping))
        append_corners(at_corners(topology.texcoords[mapping]), kNoTexcoords, list, *corners);
    if (!topology.colors.empty()) append_corners(at_corners(topology.colors), kWhiteVertices, list, list.colors);
    append_normals(at_corners(topology.normals), list);
    ++(primitive.region ? list.regions : primitive.is_triangle() ? list.triangles : list.quads);
  }
  list.smooth_vertices += two_sides ? 2 * smooth_count : smooth_count;
}

}  // namespace patchlight
