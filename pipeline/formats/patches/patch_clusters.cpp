#include "pipeline/formats/patches/patch_clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace patchlight {

namespace {

constexpr std::int32_t kFacet = -1;  // where a primitive has no row of its own in the file

/// Number of facets of the cluster that begins at each primitive; 0: none does.
std::vector<std::int32_t> cluster_sizes(const PatchSet& scene) {
  std::vector<std::int32_t> sizes(scene.primitives.size());
  for (const Patch& patch : scene.patches)
    if (patch.facets > 0) sizes[patch.primitive] = patch.facets;
  return sizes;
}

/// Calls act(values of the scene, values of the facets, value of a cluster's primitive) for all values at corners.
template <class Act>
void for_each_corner_value(PatchSet& scene, ClusterFacets& facets, Act act) {
  act(scene.texcoords, facets.texcoords, kIdentityTexcoords);
  act(scene.emission_texcoords, facets.emission_texcoords, kIdentityTexcoords);
  act(scene.metallic_roughness_texcoords, facets.metallic_roughness_texcoords, kIdentityTexcoords);
  act(scene.normal_texcoords, facets.normal_texcoords, kIdentityTexcoords);
  act(scene.colors, facets.colors, kWhiteVertices);
  act(scene.normals, facets.normals, kFlatNormals);
}

/// Reads values at the corners of facets, if the scene has such values.
template <class Corners>
void read_corners(const H5Reader& reader, const char* name, const std::vector<Corners>& of_scene, std::size_t facets,
                  std::vector<Corners>& all) {
  using Vector = typename Corners::value_type;
  if (of_scene.empty()) return;
  const int components = int(Vector::dimensions());
  const std::vector<float> values = reader.dataset<float>(name, std::int64_t(facets), components, 4);
  const float* next = values.data();
  all.resize(facets);
  for (Corners& corners : all)
    for (Vector& corner : corners)
      for (int k = 0; k < components; ++k) corner[k] = *next++;
}

template <class Corners>
void write_corners(H5Writer& writer, const char* name, const std::vector<Corners>& all) {
  using Vector = typename Corners::value_type;
  if (all.empty()) return;
  const int components = int(Vector::dimensions());
  std::vector<float> values;
  for (const Corners& corners : all)
    for (const Vector& corner : corners)
      for (int k = 0; k < components; ++k) values.push_back(corner[k]);
  writer.dataset<float>(name, values, components, 4);
}

}  // namespace

ClusterFacets take_facets(PatchSet& scene) {
  ClusterFacets facets;
  const std::vector<std::int32_t> sizes = cluster_sizes(scene);
  if (std::all_of(sizes.begin(), sizes.end(), [](std::int32_t size) { return size == 0; })) return facets;
  std::vector<Primitive> rows;
  std::vector<std::int32_t> row_of(scene.primitives.size(), kFacet), facet_of(scene.primitives.size(), -1);
  std::vector<std::int32_t> row_of_facet;
  for (std::size_t i = 0; i < scene.primitives.size();) {
    const std::int32_t size = sizes[i];
    row_of[i] = std::int32_t(rows.size());
    rows.push_back(scene.primitives[i]);
    if (size == 0) {
      ++i;
      continue;
    }
    rows.back().corners.fill(Vec3d(0.0));
    rows.back().smooth_vertices.fill(-1);
    facets.counts.push_back(size);
    for (std::int32_t k = 0; k < size; ++k, ++i) {
      facet_of[i] = std::int32_t(facets.primitives.size());
      facets.primitives.push_back(scene.primitives[i]);
      row_of_facet.push_back(std::int32_t(rows.size()) - 1);
    }
  }
  for (Primitive& facet : facets.primitives)
    if (facet.back >= 0) facet.back = facet_of[facet.back];
  for (Primitive& row : rows)
    if (row.back >= 0) row.back = facet_of[row.back] >= 0 ? row_of_facet[facet_of[row.back]] : row_of[row.back];
  for_each_corner_value(scene, facets, [&](auto& all, auto& of_facets, const auto& none) {
    if (all.empty()) return;
    std::size_t row = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (facet_of[i] >= 0) of_facets.push_back(all[i]);
      if (row_of[i] != kFacet) all[row++] = facet_of[i] >= 0 ? none : all[i];
    }
    all.resize(row);
  });
  for (Patch& patch : scene.patches) patch.primitive = row_of[patch.primitive];
  scene.primitives = std::move(rows);
  return facets;
}

void put_facets(ClusterFacets facets, PatchSet& scene) {
  if (facets.counts.empty()) return;
  const auto count = scene.primitives.size() + facets.primitives.size() - facets.counts.size();
  std::vector<std::int32_t> sizes(scene.primitives.size()), first(scene.primitives.size()), place_of_facet;
  std::size_t cluster = 0;
  for (const Patch& patch : scene.patches)
    if (patch.facets > 0) sizes[patch.primitive] = facets.counts[cluster++];
  std::vector<Primitive> primitives;
  primitives.reserve(count);
  for (std::size_t row = 0; row < scene.primitives.size(); ++row) {
    first[row] = std::int32_t(primitives.size());
    if (sizes[row] == 0) primitives.push_back(std::move(scene.primitives[row]));
    for (std::int32_t k = 0; k < sizes[row]; ++k) {
      const Primitive& facet = facets.primitives[place_of_facet.size()];
      Primitive& primitive = primitives.emplace_back(scene.primitives[row]);
      primitive.corners = facet.corners;
      primitive.smooth_vertices = facet.smooth_vertices;
      place_of_facet.push_back(std::int32_t(primitives.size()) - 1);
    }
  }
  std::size_t next = 0;
  for (std::size_t row = 0; row < sizes.size(); ++row) {
    if (sizes[row] == 0) {
      std::int32_t& back = primitives[first[row]].back;
      if (back >= 0) back = first[back];
    }
    for (std::int32_t k = 0; k < sizes[row]; ++k, ++next) {
      const std::int32_t back = facets.primitives[next].back;
      primitives[place_of_facet[next]].back = back >= 0 ? place_of_facet[back] : -1;
    }
  }
  for_each_corner_value(scene, facets, [&](auto& all, auto& of_facets, const auto&) {
    if (all.empty()) return;
    std::remove_reference_t<decltype(all)> together;
    together.reserve(count);
    std::size_t facet = 0;
    for (std::size_t row = 0; row < sizes.size(); ++row) {
      if (sizes[row] == 0) together.push_back(all[row]);
      for (std::int32_t k = 0; k < sizes[row]; ++k) together.push_back(of_facets[facet++]);
    }
    all = std::move(together);
  });
  for (Patch& patch : scene.patches) {
    if (patch.facets > 0) patch.facets = sizes[patch.primitive];
    patch.primitive = first[patch.primitive];
  }
  scene.primitives = std::move(primitives);
}

void write_cluster_datasets(H5Writer& writer, const ClusterFacets& facets) {
  if (facets.counts.empty()) return;
  std::vector<double> corners;
  std::vector<std::int32_t> smooth, backs;
  for (const Primitive& p : facets.primitives) {
    for (const Vec3d& c : p.corners) corners.insert(corners.end(), {c.x, c.y, c.z});
    smooth.insert(smooth.end(), p.smooth_vertices.begin(), p.smooth_vertices.end());
    backs.push_back(p.back);
  }
  writer.dataset<std::int32_t>("/clusters/facets", facets.counts);
  writer.dataset<double>("/facets/corners", corners, 3, 4);
  writer.dataset<std::int32_t>("/facets/smooth_vertices", smooth, 4);
  writer.dataset<std::int32_t>("/facets/back", backs);
  write_corners(writer, "/facets/texcoord", facets.texcoords);
  write_corners(writer, "/facets/emission_texcoord", facets.emission_texcoords);
  write_corners(writer, "/facets/finish_texcoord", facets.metallic_roughness_texcoords);
  write_corners(writer, "/facets/normal_texcoord", facets.normal_texcoords);
  write_corners(writer, "/facets/color", facets.colors);
  write_corners(writer, "/facets/normals", facets.normals);
}

void read_cluster_datasets(const H5Reader& reader, const std::vector<bool>& is_cluster, PatchSet& scene) {
  const auto clusters = std::count(is_cluster.begin(), is_cluster.end(), true);
  if (clusters == 0) return;
  ClusterFacets facets;
  facets.counts = reader.dataset<std::int32_t>("/clusters/facets", clusters);
  const std::vector<double> corners = reader.dataset<double>("/facets/corners", -1, 3, 4);
  const std::size_t count = corners.size() / 12;
  std::size_t left = count;
  for (const std::int32_t size : facets.counts) {
    if (size < 1 || std::size_t(size) > left) reader.refuse("a number out of bounds", "/clusters/facets");
    left -= std::size_t(size);
  }
  if (left > 0) reader.refuse("facets of no cluster", "/clusters/facets");
  const auto smooth = reader.dataset<std::int32_t>("/facets/smooth_vertices", std::int64_t(count), 4);
  const auto backs = reader.dataset<std::int32_t>("/facets/back", std::int64_t(count));
  facets.primitives.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Primitive& p = facets.primitives[i];
    for (int k = 0; k < 4; ++k) {
      const double* c = &corners[12 * i + 3 * std::size_t(k)];
      p.corners[k] = Vec3d(c[0], c[1], c[2]);
      p.smooth_vertices[k] = smooth[4 * i + std::size_t(k)];
    }
    p.back = backs[i];
    if (p.back < -1 || p.back >= std::int64_t(count)) reader.refuse("an index out of range", "/facets/back");
  }
  read_corners(reader, "/facets/texcoord", scene.texcoords, count, facets.texcoords);
  read_corners(reader, "/facets/emission_texcoord", scene.emission_texcoords, count, facets.emission_texcoords);
  read_corners(reader, "/facets/finish_texcoord", scene.metallic_roughness_texcoords, count,
               facets.metallic_roughness_texcoords);
  read_corners(reader, "/facets/normal_texcoord", scene.normal_texcoords, count, facets.normal_texcoords);
  read_corners(reader, "/facets/color", scene.colors, count, facets.colors);
  read_corners(reader, "/facets/normals", scene.normals, count, facets.normals);
  for (const CornerNormals& normals : facets.normals)
    for (const Vec3f& n : normals)
      if (normals != kFlatNormals && !(std::abs(n.length() - 1.0f) <= 1e-3f))
        reader.refuse("a vector that is not of unit length", "/facets/normals");
  std::int64_t last = -1, found = 0;
  for (Patch& patch : scene.patches) {
    if (patch.primitive < std::max(last, std::int64_t(0)) || patch.primitive >= std::int64_t(is_cluster.size()))
      reader.refuse("an index out of order", "/patches/primitive");
    if (is_cluster[patch.primitive]) {
      if (patch.primitive == last) reader.refuse("a cluster of more than one patch", "/patches/primitive");
      patch.facets = 1;  // put_facets() sets the number
      ++found;
    }
    last = patch.primitive;
  }
  if (found != clusters) reader.refuse("a cluster without a patch", "/patches/primitive");
  for (const Primitive& p : scene.primitives)
    if (p.back < -1 || p.back >= std::int64_t(scene.primitives.size()))
      reader.refuse("an index out of range", "/primitives/back");
  put_facets(std::move(facets), scene);
}

PatchFault cluster_fault(const PatchSet& scene) {
  for (const Patch& patch : scene.patches) {
    if (patch.facets == 0) continue;
    if (patch.u0 != 0 || patch.v0 != 0 || patch.u1 != 0 || patch.v1 != 0) return {"a part of a cluster", "/patches/uv"};
    const Primitive& first = scene.primitives[patch.primitive];
    if (first.light_group >= 0 || first.mask >= 0) return {"a cluster that emits light or has a mask", "/primitives"};
  }
  const std::vector<bool> is_facet = facets_of_clusters(scene);
  for (std::size_t i = 0; i < scene.primitives.size(); ++i)
    if (const std::int32_t back = scene.primitives[i].back; back >= 0 && is_facet[i] != is_facet[back])
      return {"two sides of which one is of a cluster", "/primitives/back"};
  return {};
}

}  // namespace patchlight
