#include "pipeline/formats/patches/patch_file.h"

#include <algorithm>
#include <array>

#include "pipeline/formats/patches/light_distributions.h"
#include "pipeline/formats/patches/patch_cameras.h"
#include "pipeline/formats/patches/patch_check.h"
#include "pipeline/formats/patches/patch_clusters.h"
#include "pipeline/formats/patches/patch_cuts.h"
#include "pipeline/formats/patches/patch_environment.h"
#include "pipeline/formats/patches/patch_lights.h"
#include "pipeline/formats/patches/patch_materials.h"
#include "pipeline/formats/patches/patch_regions.h"
#include "pipeline/formats/patches/patch_rows.h"
#include "pipeline/formats/patches/patch_shaders.h"
#include "pipeline/formats/patches/patch_textures.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/hdf5/provenance_file.h"
#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace {

constexpr std::int32_t kClusterType = 2, kRegionType = 3;  // in /primitives/type; others: Primitive::Shape

void write_primitives(H5Writer& writer, const PatchSet& scene) {
  const auto& all = scene.primitives;
  using P = const Primitive&;
  std::vector<std::int32_t> types;
  for (const Primitive& p : all) types.push_back(p.region ? kRegionType : std::int32_t(p.shape));
  for (const Patch& patch : scene.patches)
    if (patch.facets > 0) types[patch.primitive] = kClusterType;
  writer.dataset<std::int32_t>("/primitives/type", types);
  write_rows<double>(
      writer, "/primitives/corners", all, 3,
      [](P p, auto* r) {
        for (int k = 0; k < 4; ++k) put3(r + 3 * k, p.corners[k]);
      },
      4);
  write_rows<double>(writer, "/primitives/sphere", all, 4, [](P p, auto* r) {
    put3(r, p.sphere_center);
    r[3] = p.sphere_radius;
  });
  write_rows<std::int32_t>(writer, "/primitives/material", all, 0, [](P p, auto* r) { *r = p.material; });
  write_rows<std::int32_t>(writer, "/primitives/light_group", all, 0, [](P p, auto* r) { *r = p.light_group; });
  write_rows<std::int32_t>(writer, "/primitives/back", all, 0, [](P p, auto* r) { *r = p.back; });
  write_rows<std::int32_t>(writer, "/primitives/smooth_vertices", all, 4,
                           [](P p, auto* r) { std::copy(p.smooth_vertices.begin(), p.smooth_vertices.end(), r); });
  write_rows<std::int32_t>(writer, "/primitives/node", all, 0, [](P p, auto* r) { *r = p.node; });
  write_rows<double>(writer, "/primitives/patch_area", all, 0, [](P p, auto* r) { *r = p.patch_area; });
  if (has_intangible(all))
    write_rows<std::int32_t>(writer, "/primitives/intangible", all, 0, [](P p, auto* r) { *r = p.intangible; });
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const auto& p : all) names.push_back(scene.nodes[p.node]);
  writer.strings("/primitives/name", names);
  writer.strings("/nodes/name", scene.nodes);
  if (!scene.unseen.empty()) writer.dataset<std::int32_t>("/nodes/unseen", scene.unseen, 0);
}

void write_patch_rows(H5Writer& writer, const PatchSet& scene) {
  const auto& all = scene.patches;
  using P = const Patch&;
  write_rows<double>(writer, "/patches/center", all, 3, [](P p, auto* r) { put3(r, p.center); });
  write_rows<float>(writer, "/patches/normal", all, 3, [](P p, auto* r) { put3(r, p.normal); });
  write_rows<double>(writer, "/patches/area", all, 0, [](P p, auto* r) { *r = p.area; });
  write_rows<float>(writer, "/patches/reflectance", all, 3, [](P p, auto* r) { put3(r, p.reflectance); });
  write_rows<float>(writer, "/patches/emission", all, 3, [](P p, auto* r) { put3(r, p.emission); });
  write_rows<std::int32_t>(writer, "/patches/primitive", all, 0, [](P p, auto* r) { *r = p.primitive; });
  write_rows<float>(writer, "/patches/uv", all, 4, [](P p, auto* r) {
    const std::array<float, 4> uv{p.u0, p.v0, p.u1, p.v1};
    std::copy(uv.begin(), uv.end(), r);
  });
}

void write_materials(H5Writer& writer, const std::vector<Material>& materials) {
  using M = const Material&;
  std::vector<std::string> names;
  for (const auto& m : materials) names.push_back(m.name);
  writer.strings("/materials/name", names);
  write_rows<float>(writer, "/materials/specular", materials, 3, [](M m, auto* r) { put3(r, m.specular); });
  write_rows<float>(writer, "/materials/roughness", materials, 0, [](M m, auto* r) { *r = m.roughness; });
}

void write_sources(H5Writer& writer, const std::vector<SourceFile>& sources) {
  std::vector<std::string> paths, hashes;
  for (const auto& source : sources) {
    paths.push_back(source.path);
    hashes.push_back(source.hash);
  }
  writer.strings("/sources/path", paths);
  writer.strings("/sources/hash", hashes);
}

/// Returns which of them are clusters.
std::vector<bool> read_primitives(const H5Reader& reader, PatchSet& scene) {
  auto& all = scene.primitives;
  using P = Primitive&;
  scene.nodes = reader.strings("/nodes/name", -1);
  if (reader.has("/nodes/unseen"))
    scene.unseen = reader.dataset<std::int32_t>("/nodes/unseen", std::int64_t(scene.nodes.size()));
  all.resize(std::size_t(reader.rows("/primitives/type")));
  std::vector<bool> is_region, is_cluster;
  read_rows<std::int32_t>(reader, "/primitives/type", all, 0, [&](P p, auto* r) {
    if (*r < 0 || *r > kRegionType) reader.refuse("unknown primitive type", "/primitives/type");
    p.shape = *r == 1 ? Primitive::Shape::sphere : Primitive::Shape::quad;
    is_region.push_back(*r == kRegionType);
    is_cluster.push_back(*r == kClusterType);
  });
  read_region_datasets(reader, is_region, scene);
  read_rows<double>(
      reader, "/primitives/corners", all, 3,
      [](P p, auto* r) {
        for (int k = 0; k < 4; ++k) p.corners[k] = get3<Vec3d>(r + 3 * k);
      },
      4);
  read_rows<double>(reader, "/primitives/sphere", all, 4, [](P p, auto* r) {
    p.sphere_center = get3<Vec3d>(r);
    p.sphere_radius = r[3];
  });
  read_rows<std::int32_t>(reader, "/primitives/material", all, 0, [](P p, auto* r) { p.material = *r; });
  read_rows<std::int32_t>(reader, "/primitives/light_group", all, 0, [](P p, auto* r) { p.light_group = *r; });
  read_rows<std::int32_t>(reader, "/primitives/back", all, 0, [](P p, auto* r) { p.back = *r; });
  read_rows<std::int32_t>(reader, "/primitives/smooth_vertices", all, 4,
                          [](P p, auto* r) { std::copy_n(r, 4, p.smooth_vertices.begin()); });
  read_rows<std::int32_t>(reader, "/primitives/node", all, 0, [](P p, auto* r) { p.node = *r; });
  if (reader.has("/primitives/patch_area"))
    read_rows<double>(reader, "/primitives/patch_area", all, 0, [](P p, auto* r) { p.patch_area = *r; });
  if (reader.has("/primitives/intangible"))
    read_rows<std::int32_t>(reader, "/primitives/intangible", all, 0, [](P p, auto* r) { p.intangible = *r != 0; });
  return is_cluster;
}

void read_patch_rows(const H5Reader& reader, std::vector<Patch>& all) {
  using P = Patch&;
  all.resize(std::size_t(reader.rows("/patches/area")));
  read_rows<double>(reader, "/patches/center", all, 3, [](P p, auto* r) { p.center = get3<Vec3d>(r); });
  read_rows<float>(reader, "/patches/normal", all, 3, [](P p, auto* r) { p.normal = get3<Vec3f>(r); });
  read_rows<double>(reader, "/patches/area", all, 0, [](P p, auto* r) { p.area = *r; });
  read_rows<float>(reader, "/patches/reflectance", all, 3, [](P p, auto* r) { p.reflectance = get3<Color>(r); });
  read_rows<float>(reader, "/patches/emission", all, 3, [](P p, auto* r) { p.emission = get3<Color>(r); });
  read_rows<std::int32_t>(reader, "/patches/primitive", all, 0, [](P p, auto* r) { p.primitive = *r; });
  read_rows<float>(reader, "/patches/uv", all, 4, [](P p, auto* r) {
    p.u0 = r[0];
    p.v0 = r[1];
    p.u1 = r[2];
    p.v1 = r[3];
  });
}

void read_materials(const H5Reader& reader, std::vector<Material>& materials) {
  using M = Material&;
  for (const auto& name : reader.strings("/materials/name", -1)) materials.push_back({name, Color(0.0f), 1.0f});
  read_rows<float>(reader, "/materials/specular", materials, 3, [](M m, auto* r) { m.specular = get3<Color>(r); });
  read_rows<float>(reader, "/materials/roughness", materials, 0, [](M m, auto* r) { m.roughness = *r; });
}

}  // namespace

void write_patches(const std::filesystem::path& file, PatchSet& scene) {
  H5Writer writer(file);
  ClusterFacets facets = take_facets(scene);
  write_patch_rows(writer, scene);
  write_cut_datasets(writer, scene);
  write_primitives(writer, scene);
  write_region_datasets(writer, scene);
  write_materials(writer, scene.materials);
  write_coat_datasets(writer, scene);
  write_transmissions(writer, scene.materials);
  write_translucences(writer, scene.materials);
  write_camera_datasets(writer, scene);
  write_sources(writer, scene.sources);
  writer.strings("/light_groups/name", scene.light_groups);
  write_light_datasets(writer, scene);
  write_distribution_datasets(writer, scene);
  write_environment_datasets(writer, scene);
  write_shader_datasets(writer, scene);
  write_texture_datasets(writer, scene);
  write_cluster_datasets(writer, facets);

  const std::vector<std::string> textures = transport_textures(scene);
  const std::string metallic_roughness = metallic_roughness_key(scene);
  const auto key_of = [&](std::vector<std::string> names) {
    names.insert(names.end(), textures.begin(), textures.end());
    return KeyHasher().add(writer.key_of(names)).add(metallic_roughness).hex();
  };
  scene.key = key_of({"/patches/",
                      "/cuts/",
                      "/regions/",
                      "/clusters/",
                      "/facets/corners",
                      "/facets/smooth_vertices",
                      "/facets/back",
                      "/facets/normals",
                      "/primitives/type",
                      "/primitives/corners",
                      "/primitives/sphere",
                      "/primitives/back",
                      "/primitives/smooth_vertices",
                      "/primitives/normals",
                      "/primitives/patch_area",
                      "/primitives/light_group",
                      "/materials/translucence",
                      "/primitives/intangible",
                      "/light_groups/",
                      "/lights/kind",
                      "/lights/light_group",
                      "/lights/strength",
                      "/lights/shape",
                      "/lights/radius",
                      "/lights/distribution",
                      "/lights/across",
                      "/distributions/",
                      "/environment/cells",
                      "/environment/light_group"});
  scene.geometry_key =
      key_of({"/patches/center", "/patches/primitive", "/patches/uv", "/cuts/", "/regions/", "/clusters/",
              "/facets/corners", "/facets/smooth_vertices", "/facets/back", "/facets/normals", "/primitives/type",
              "/primitives/corners", "/primitives/sphere", "/primitives/back", "/primitives/smooth_vertices",
              "/primitives/normals", "/primitives/patch_area", "/primitives/intangible", "/environment/rows"});
  scene.frames_key = writer.key_of({"/primitives/material",
                                    "/nodes/unseen",
                                    "/shaders/",
                                    "/primitives/shader",
                                    "/primitives/texcoord",
                                    "/textures/",
                                    "/primitives/texture",
                                    "/materials/tint",
                                    "/primitives/color",
                                    "/primitives/emission_tex",
                                    "/primitives/finish_tex",
                                    "/primitives/normal_tex",
                                    "/materials/normal_scale",
                                    "/facets/normal_tex",
                                    "/facets/texcoord",
                                    "/facets/emission_tex",
                                    "/facets/finish_tex",
                                    "/facets/color",
                                    "/materials/metal",
                                    "/materials/finish_roughness",
                                    "/materials/emission_tint",
                                    "/environment/size",
                                    "/environment/texels",
                                    "/environment/view"});
  writer.attribute("format", kPatchFormat);
  writer.attribute("version", std::int64_t(kPatchVersion));
  writer.attribute("key", scene.key);
  writer.attribute("geometry_key", scene.geometry_key);
  writer.attribute("frames_key", scene.frames_key);
  writer.attribute("inputs_key", scene.inputs_key);
  write_provenance(writer, scene.made);
  writer.commit();
  put_facets(std::move(facets), scene);
}

PatchSet read_patches(const std::filesystem::path& file) {
  const H5Reader reader(file, kPatchFormat, kPatchVersion);
  PatchSet scene;
  scene.key = reader.text("key");
  scene.geometry_key = reader.text("geometry_key");
  scene.frames_key = reader.text("frames_key");
  scene.inputs_key = reader.text("inputs_key");
  scene.made = read_provenance(reader);
  read_patch_rows(reader, scene.patches);
  const std::vector<bool> is_cluster = read_primitives(reader, scene);
  read_cut_datasets(reader, scene);
  read_materials(reader, scene.materials);
  read_coat_datasets(reader, scene);
  read_transmissions(reader, scene.materials);
  read_translucences(reader, scene.materials);
  read_camera_datasets(reader, scene);
  scene.light_groups = reader.strings("/light_groups/name", -1);
  read_light_datasets(reader, scene);
  read_distribution_datasets(reader, scene);
  read_environment_datasets(reader, scene);
  read_shader_datasets(reader, scene);
  read_texture_datasets(reader, scene);
  read_cluster_datasets(reader, is_cluster, scene);
  const std::vector<std::string> paths = reader.strings("/sources/path", -1);
  const std::vector<std::string> hashes = reader.strings("/sources/hash", std::int64_t(paths.size()));
  for (std::size_t i = 0; i < paths.size(); ++i) scene.sources.push_back({paths[i], hashes[i]});
  if (const PatchFault fault = find_fault(scene)) reader.refuse(fault.what, fault.where);
  set_triangles(scene);
  if (const PatchFault fault = area_fault(scene)) reader.refuse(fault.what, fault.where);
  return scene;
}

}  // namespace patchlight
