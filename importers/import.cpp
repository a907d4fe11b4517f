#include "importers/import.h"

#include <ImathBox.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "importers/environment/environment.h"
#include "importers/gltf/read/cameras.h"
#include "importers/gltf/read/gltf_reader.h"
#include "importers/mesh/mesh_topology.h"
#include "importers/mesh/surface_boxes.h"
#include "importers/patches/facet_clusters.h"
#include "importers/patches/large_surfaces.h"
#include "importers/patches/patch_areas.h"
#include "importers/patches/patch_builder.h"
#include "importers/patches/patch_colors.h"
#include "importers/patches/patch_cuts.h"
#include "importers/patches/patch_grid.h"
#include "importers/patches/primitive_builder.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

bool is_closed(const TriangleSoup& soup) {
  const MeshTopology topology = build_topology(soup);
  return std::ranges::all_of(topology.components, &MeshTopology::Component::closed);
}

/// Makes glass of meshes that are not closed, which bound no body, thin sheets.
class OpenGlass {
 public:
  explicit OpenGlass(GltfScene& scene) : scene_(scene) {}

  void check(const TriangleSoup& soup, Surface& surface, Progress& progress) {
    if (!scene_.materials[surface.material].transmission.solid || is_closed(soup)) return;
    const auto [entry, is_new] = thin_.emplace(surface.material, static_cast<int>(scene_.materials.size()));
    if (is_new) {
      SurfaceMaterial sheet = scene_.materials[surface.material];
      sheet.transmission.solid = false;
      progress.warning(
          fmt::format("glass of material '{}' has a thickness, but the mesh of node `{}` is not closed: it "
                      "is a thin sheet there",
                      sheet.name, scene_.nodes[surface.node]));
      scene_.materials.push_back(std::move(sheet));
    }
    surface.material = entry->second;
  }

 private:
  GltfScene& scene_;
  std::map<int, int> thin_;  ///< Materials, and those of sheets.
};

/// Tells of which surfaces no light reaches the back, if they are closed. Reads the scene's triangles once it is asked.
class DarkInsides {
 public:
  explicit DarkInsides(const GltfScene& scene) : scene_(scene) {
    for (const Light& light : scene.lights)
      if (light.kind != Light::Kind::sun) lights_.push_back(light.position);
  }

  bool operator()(std::size_t index) {
    constexpr std::int64_t kMostTriangles = 1 << 22;  // all backs are kept where the boxes would fill the memory
    const Surface& surface = scene_.surfaces[index];
    const bool lets_light_in = surface.is_masked || scene_.materials[surface.material].transmission.exists() ||
                               scene_.materials[surface.material].translucence != Color(0.0f);
    if (lets_light_in || surface.light_group >= 0 || scene_.triangles > kMostTriangles) return false;
    if (!boxes_) {
      boxes_.emplace();
      for (const Surface& other : scene_.surfaces) boxes_->add(read_triangles(scene_, other));
    }
    return boxes_->is_empty(index, lights_);
  }

 private:
  const GltfScene& scene_;
  std::vector<Vec3d> lights_;
  std::optional<SurfaceBoxes> boxes_;
};

PrimitiveList build_primitives(GltfScene& scene, const Job& job, Progress& progress) {
  PrimitiveList list;
  DarkInsides dark_insides(scene);
  OpenGlass open_glass(scene);
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    Surface& surface = scene.surfaces[i];
    const TriangleSoup soup = read_triangles(scene, surface);
    open_glass.check(soup, surface, progress);
    append_primitives(
        surface, scene.materials[surface.material], soup, [&] { return dark_insides(i); }, list);
    if (static_cast<std::int64_t>(list.primitives.size()) > job.import.max_patches) {
      throw Error(ExitCode::over_limit,
                  fmt::format("the scene has more surfaces than import.max_patches ({})", job.import.max_patches),
                  "import.max_patches", "raise it, or simplify the scene");
    }
    progress.update(static_cast<double>(i + 1) / static_cast<double>(scene.surfaces.size()), scene.nodes[surface.node]);
  }
  if (list.degenerate_triangles > 0)
    progress.warning(fmt::format("{} triangles without area are skipped", list.degenerate_triangles));
  if (list.invalid_normals > 0)
    progress.warning(
        fmt::format("{} corners have a normal that is not a unit vector or points behind its triangle: their triangles "
                    "are shaded flat",
                    list.invalid_normals));
  if (!list.texcoords.empty()) list.texcoords.resize(list.primitives.size(), kIdentityTexcoords);
  for (auto* texcoords : {&list.emission_texcoords, &list.metallic_roughness_texcoords, &list.normal_texcoords}) {
    if (texcoords->empty()) continue;
    texcoords->resize(list.primitives.size(), kNoTexcoords);
    for (std::size_t i = 0; i < texcoords->size(); ++i)
      if (std::isnan((*texcoords)[i][0].x))
        (*texcoords)[i] = list.texcoords.empty() ? kIdentityTexcoords : list.texcoords[i];
  }
  if (!list.colors.empty()) list.colors.resize(list.primitives.size(), kWhiteVertices);
  if (!list.normals.empty()) list.normals.resize(list.primitives.size(), kFlatNormals);
  if (list.primitives.empty()) {
    throw Error(ExitCode::bad_data, "the scene has no surface with an area", job.scene.filename().string(),
                "add a mesh to its default scene");
  }
  return list;
}

std::vector<Material> stored_materials(const std::vector<SurfaceMaterial>& materials) {
  std::vector<Material> result;
  for (const SurfaceMaterial& material : materials)
    result.push_back({material.name, material.specular, material.roughness, material.tint, material.alpha,
                      material.alpha_cutoff, material.metal, material.roughness_factor, material.emission_tint,
                      material.coat, material.transmission, material.normal_scale, material.translucence,
                      material.clear_coat});
  return result;
}

std::int64_t masked_primitives(const PatchSet& set) {
  return std::count_if(set.primitives.begin(), set.primitives.end(), [](const Primitive& p) { return p.mask >= 0; });
}

/// The target area of a primitive's patches, m2; that of its grid's cells if it has one of its own.
double target_area(const Primitive& primitive, const PatchTarget& target) {
  if (target.grid.columns == 0) return target.area;
  const double whole = primitive_area(primitive) / (primitive.region ? primitive.region->area() : 1.0);
  return std::min(target.area, whole / (static_cast<double>(target.grid.columns) * target.grid.rows));
}

std::string clusters_text(const PatchSet& set) {
  std::size_t clusters = 0;
  std::int64_t facets = 0;
  for (const Patch& patch : set.patches) {
    clusters += patch.facets > 0;
    facets += patch.facets;
  }
  return clusters == 0 ? "" : fmt::format(", {} of them clusters of {} facets", clusters, facets);
}

std::string summary(const GltfScene& scene, const PrimitiveList& list, const PatchSet& set) {
  std::vector<char> used(scene.materials.size(), 0);
  for (const Surface& surface : scene.surfaces) used[surface.material] = 1;
  int mirrors = 0, coats = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] && scene.materials[i].specular != Color(0.0f)) ++mirrors;
    if (used[i] && (scene.materials[i].coat.exists() || scene.materials[i].clear_coat.exists())) ++coats;
  }
  const auto moving = std::count_if(set.cameras.begin(), set.cameras.end(),
                                    [](const Camera& camera) { return !camera.motion.empty(); });
  return fmt::format(
      "{} triangles{} read as {} quads, {} triangles, {} spheres{}{}; {} patches{}; modelled: {} metallic materials{}, "
      "{} light groups, {} cameras{}{}{}{}{}{}",
      scene.triangles,
      list.added_triangles > 0
          ? fmt::format(", {} when split at vertices on their edges,", scene.triangles + list.added_triangles)
          : "",
      list.quads, list.triangles, list.spheres,
      list.regions > 0 ? fmt::format(", {} planar regions", list.regions) : "",
      list.merged_facets == 0
          ? ""
          : fmt::format(" ({} of them from {} coplanar triangles)", list.merged_facets, list.merged_triangles),
      set.patches.size(), clusters_text(set), mirrors, coats > 0 ? fmt::format(", {} coated ones", coats) : "",
      set.light_groups.size(), set.cameras.size(), moving > 0 ? fmt::format(" ({} animated)", moving) : "",
      set.lights.empty() ? "" : fmt::format(", {} point lights, spots and suns", set.lights.size()),
      set.environment ? ", an environment" : "",
      set.textures.empty() ? "" : fmt::format(", {} textures", set.textures.size()),
      set.masks.empty() ? "" : fmt::format(", alpha masks on {} surfaces", masked_primitives(set)),
      set.shaders.empty() ? "" : fmt::format(", {} shaders", set.shaders.size()));
}

/// Marks the surfaces of nodes that ask for it as intangible. Only lamps that reflect nothing may be: rays never meet
/// them.
void mark_intangible(const GltfScene& scene, PatchSet& set, Progress& progress) {
  std::vector<std::int32_t> wanted = scene.intangible;
  for (const Patch& patch : set.patches) {
    const Primitive& p = set.primitives[patch.primitive];
    const bool is_lamp = p.light_group >= 0 && p.mask < 0 && patch.reflectance == Color(0.0f) &&
                         scene.materials[p.material].specular == Color(0.0f);
    if (is_lamp || !wanted[p.node]) continue;
    wanted[p.node] = 0;
    progress.warning(
        fmt::format("node `{}` is `intangible`, but not a lamp that reflects nothing: it hides what is behind it",
                    scene.nodes[p.node]));
  }
  for (Primitive& p : set.primitives) p.intangible = wanted[p.node] != 0;
}

}  // namespace

PatchSet import_scene(const Job& job, Progress& progress) {
  for (const std::string& warning : job.export_warnings) progress.warning(warning);
  GltfScene scene = read_gltf_scene(job, progress);
  PrimitiveList list = build_primitives(scene, job, progress);

  PatchSet set;
  const std::vector<double> patch_areas = choose_patch_areas(list.primitives, scene.materials, job.import);
  std::vector<PatchTarget> targets = divide_large_surfaces(scene.materials, patch_areas, job.import, list);
  const std::vector<FacetCluster> clusters = cluster_facets(scene.materials, targets, list);
  set.patches = build_patches(list.primitives, scene.materials, targets, clusters);
  set.primitives = std::move(list.primitives);
  for (std::size_t i = 0; i < targets.size(); ++i)
    set.primitives[i].patch_area = target_area(set.primitives[i], targets[i]);
  set.texcoords = std::move(list.texcoords);
  set.emission_texcoords = std::move(list.emission_texcoords);
  set.metallic_roughness_texcoords = std::move(list.metallic_roughness_texcoords);
  set.normal_texcoords = std::move(list.normal_texcoords);
  set.colors = std::move(list.colors);
  set.normals = std::move(list.normals);
  set.shaders = scene.shaders;
  if (!scene.intangible.empty()) mark_intangible(scene, set, progress);
  const std::size_t whole = set.patches.size();
  cut_patches(targets, set);
  if (static_cast<std::int64_t>(set.patches.size()) > job.import.max_patches) {
    throw Error(ExitCode::over_limit,
                fmt::format("{} patches, {} of them parts that other surfaces cut off, are more than "
                            "import.max_patches, {}",
                            set.patches.size(), set.patches.size() - whole, job.import.max_patches),
                "import.max_patches", "raise it or import.patch_area");
  }
  set.textures = std::move(scene.textures);
  if (masked_primitives(set) > 0) set.masks = std::move(scene.masks);
  set.materials = stored_materials(scene.materials);
  set.nodes = scene.nodes;
  set.unseen = scene.unseen;
  set.light_groups = scene.light_groups;
  set.lights = std::move(scene.lights);
  set.distributions = std::move(scene.distributions);
  set.cameras = scene.cameras;
  if (set.cameras.empty()) {
    const Imath::Box3d box = bounds_of(set.primitives);
    set.cameras.push_back(framing_camera(box.min, box.max));
  }
  set.sources = scene.sources;
  if (!set.shaders.empty() || !set.textures.empty() || !set.masks.empty() || !set.colors.empty())
    average_colors(job, set, progress);
  average_coats(set);
  add_environment(job, set, progress);
  set.inputs_key = import_inputs_key(set.sources, job);
  progress.note(summary(scene, list, set));
  return set;
}

}  // namespace patchlight
