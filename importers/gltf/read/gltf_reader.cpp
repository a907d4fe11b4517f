#include "importers/gltf/read/gltf_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "importers/gltf/model/gltf_model.h"
#include "importers/gltf/read/cameras.h"
#include "importers/gltf/read/instances.h"
#include "importers/gltf/read/lights.h"
#include "importers/gltf/read/materials.h"
#include "importers/gltf/read/motion.h"
#include "importers/gltf/read/node_overrides.h"
#include "importers/gltf/read/pose.h"
#include "importers/gltf/read/shader_assignment.h"
#include "pipeline/job/light_group_name.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

/// Maximum number of triangles per permitted patch; spheres have many triangles and few patches.
constexpr std::int64_t kTrianglesPerPatch = 20;
constexpr std::size_t kMaxLights = 1000;             // every patch and every pixel samples each of them
constexpr std::int64_t kMaxTriangles = 600'000'000;  // corner indices have 32 bits

struct PlacedNode {
  int node;
  Matrix4 to_world;
  bool hidden;  ///< Its mesh and its light are left out.
};

std::vector<int> root_nodes(const tinygltf::Model& gltf) {
  if (!gltf.scenes.empty()) return gltf.scenes[std::max(gltf.defaultScene, 0)].nodes;
  std::vector<char> is_child(gltf.nodes.size(), 0);
  for (const tinygltf::Node& node : gltf.nodes) {
    for (const int child : node.children) is_child[child] = 1;
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < gltf.nodes.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

/// The nodes of the scene with their transforms, parents before children, in the file's order.
std::vector<PlacedNode> placed_nodes(const GltfModel& model) {
  const tinygltf::Model& gltf = model.gltf;
  std::vector<PlacedNode> placed;
  std::vector<PlacedNode> pending;
  const auto push = [&](const std::vector<int>& nodes, const Matrix4& parent, bool hidden) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
      pending.push_back({*node, local_matrix(gltf.nodes[*node]) * parent, hidden || model.checked.hidden[*node] != 0});
    }
  };
  push(root_nodes(gltf), Matrix4(), false);
  while (!pending.empty()) {
    const PlacedNode node = pending.back();
    pending.pop_back();
    const Matrix4& m = node.to_world;
    if (std::abs(m[0][3]) + std::abs(m[1][3]) + std::abs(m[2][3]) + std::abs(m[3][3] - 1.0) > 1e-6) {
      throw Error(ExitCode::bad_data, "the transform is not affine",
                  fmt::format("{}, nodes[{}]", model.file.name, node.node),
                  "the last row of its matrix must be 0 0 0 1");
    }
    placed.push_back(node);
    push(gltf.nodes[node.node].children, node.to_world, node.hidden);
  }
  return placed;
}

std::int64_t triangle_limit(const ImportConfig& config) {
  return std::min(config.max_patches, kMaxTriangles / kTrianglesPerPatch) * kTrianglesPerPatch;
}

std::vector<Surface> placed_surfaces(const GltfModel& model, const std::vector<PlacedNode>& nodes, std::int64_t limit,
                                     std::int64_t& triangles) {
  std::vector<Surface> surfaces;
  const int default_material = static_cast<int>(model.gltf.materials.size());
  for (const PlacedNode& node : nodes) {
    const int mesh = model.gltf.nodes[node.node].mesh;
    if (mesh < 0 || node.hidden) continue;
    const std::vector<MeshPart>& parts = model.mesh_parts[mesh];
    const bool empty =
        std::all_of(parts.begin(), parts.end(), [](const MeshPart& part) { return part.triangles == 0; });
    if (empty) continue;
    const std::vector<Matrix4> instances = instances_of(model, node.node);
    for (std::size_t k = 0; k < parts.size() * instances.size(); ++k) {
      const std::size_t part = k % parts.size();
      triangles += parts[part].triangles;
      if (triangles > limit) {
        throw Error(ExitCode::over_limit, fmt::format("the scene has more than {} triangles", limit), model.file.name,
                    fmt::format("simplify it or raise import.max_patches; {} triangles are allowed per patch",
                                kTrianglesPerPatch));
      }
      Surface surface;
      surface.node = node.node;
      surface.material = parts[part].material < 0 ? default_material : parts[part].material;
      surface.to_world = instances[k / parts.size()] * node.to_world;
      surface.mesh = mesh;
      surface.part = static_cast<int>(part);
      surfaces.push_back(surface);
    }
  }
  return surfaces;
}

std::string light_group(const tinygltf::Node& node, const SurfaceMaterial& material) {
  std::string name = material.light_group_from_job ? material.light_group : "";
  if (name.empty() && node.extras.Has("light_group") && node.extras.Get("light_group").IsString()) {
    name = node.extras.Get("light_group").Get<std::string>();
  }
  if (name.empty()) name = material.light_group;
  return light_group_name(name.empty() ? material.name : name);
}

/// Collects the light groups of a scene.
class LightGroups {
 public:
  LightGroups(const GltfModel& model, GltfScene& scene) : model_(model), scene_(scene) {}

  /// Index of a group, added if it is new. `source`: the kind of object that may have given its name.
  int index_of(const std::string& name, const std::string& node, const char* source) {
    if (name.size() > kLongestLightGroup) {
      throw Error(
          ExitCode::bad_data, fmt::format("the name of a light group has {} bytes", name.size()),
          fmt::format("{}, node {}", model_.file.name, node),
          fmt::format("shorten it to {} bytes; by default it is the name of the {}", kLongestLightGroup, source));
    }
    const auto [entry, is_new] = numbers_.emplace(name, static_cast<int>(scene_.light_groups.size()));
    if (is_new) scene_.light_groups.push_back(name);
    return entry->second;
  }

 private:
  const GltfModel& model_;
  GltfScene& scene_;
  std::map<std::string, int> numbers_;
};

/// Marks the nodes with surfaces that cameras do not see or that rays pass, by their extras `visible_camera` and
/// `intangible`: true or false, or 1 or 0 as Blender writes it.
void mark_ray_visibility(const GltfModel& model, GltfScene& scene) {
  const auto mark = [&](std::int32_t node, const char* name, bool wanted, std::vector<std::int32_t>& marks) {
    const tinygltf::Value& extras = model.gltf.nodes[node].extras;
    if (!extras.Has(name)) return;
    const tinygltf::Value& value = extras.Get(name);
    if (!value.IsBool() && !value.IsNumber()) return;
    if ((value.IsBool() ? value.Get<bool>() : value.GetNumberAsDouble() != 0) != wanted) return;
    marks.resize(scene.nodes.size());
    marks[node] = 1;
  };
  for (const Surface& surface : scene.surfaces) {
    mark(surface.node, "visible_camera", false, scene.unseen);
    mark(surface.node, "intangible", true, scene.intangible);
  }
}

void assign_light_groups(const GltfModel& model, LightGroups& groups, GltfScene& scene) {
  for (Surface& surface : scene.surfaces) {
    const SurfaceMaterial& material = scene.materials[surface.material];
    const bool shader_emits = surface.shader >= 0 && is_set(scene.shaders[surface.shader].emission);
    if (!material.emits() && !shader_emits) continue;
    const std::string name = light_group(model.gltf.nodes[surface.node], material);
    surface.light_group = groups.index_of(name, scene.nodes[surface.node], "emitting material");
  }
}

void place_lights(GltfModel& model, const Job& job, const std::vector<PlacedNode>& nodes, LightGroups& groups,
                  GltfScene& scene, Progress& progress) {
  PhotometricFiles files(model, job, scene.distributions);
  for (const PlacedNode& node : nodes) {
    if (node.hidden) continue;
    auto placed = placed_light(model, job, scene.nodes, node.node, node.to_world, files, progress);
    if (!placed) continue;
    if (scene.lights.size() == kMaxLights)
      throw Error(ExitCode::over_limit, fmt::format("the scene has more than {} lights", kMaxLights), model.file.name,
                  "exclude some in the job's `nodes`, or replace them by emissive surfaces; this limit is fixed");
    placed->light.light_group = groups.index_of(placed->group, placed->light.name, "light");
    scene.lights.push_back(std::move(placed->light));
  }
  check_light_settings(model, job, scene);
}

/// Vertex colours apply unless the job or a shader sets the reflectance; vertex alpha applies if there is a mask.
void assign_vertex_colors(const GltfModel& model, GltfScene& scene) {
  for (Surface& surface : scene.surfaces) {
    const SurfaceMaterial& material = scene.materials[surface.material];
    const MeshPart& part = model.mesh_parts[surface.mesh][surface.part];
    const bool shaded = surface.shader >= 0 && is_set(scene.shaders[surface.shader].reflectance);
    surface.needs_colors = part.has_colors && !shaded && !material.reflectance_overridden;
    surface.is_masked = material.mask >= 0 && (part.has_alphas || !material.masked_by_vertices_only);
    surface.needs_alphas = part.has_alphas && surface.is_masked;
  }
}

/// Removes surfaces whose alpha test fails everywhere.
void remove_invisible(const GltfModel& model, GltfScene& scene, Progress& progress) {
  std::set<std::string> names;
  std::erase_if(scene.surfaces, [&](const Surface& surface) {
    const SurfaceMaterial& material = scene.materials[surface.material];
    if (!material.invisible) return false;
    names.insert(material.name);
    scene.triangles -= model.mesh_parts[surface.mesh][surface.part].triangles;
    return true;
  });
  for (const std::string& name : names)
    progress.warning(
        fmt::format("surfaces of material '{}' are skipped: their alpha is 0, or below the cutoff, everywhere", name));
}

/// Names the nodes of surfaces that have no material, unless the job says what these reflect.
void warn_of_missing_materials(const GltfScene& scene, std::size_t default_material, Progress& progress) {
  constexpr std::size_t kMaxNames = 5;
  if (default_material >= scene.materials.size() || scene.materials[default_material].reflectance_overridden) return;
  std::vector<std::string> names;
  std::set<int> nodes;
  for (const Surface& surface : scene.surfaces) {
    const bool shaded = surface.shader >= 0 && is_set(scene.shaders[surface.shader].reflectance);
    if (shaded || surface.material != static_cast<int>(default_material) || !nodes.insert(surface.node).second)
      continue;
    if (names.size() < kMaxNames) names.push_back("`" + scene.nodes[surface.node] + "`");
  }
  if (names.empty()) return;
  const std::string more = nodes.size() > names.size() ? fmt::format(" and {} more", nodes.size() - names.size()) : "";
  progress.warning(
      fmt::format("a surface without a material is diffuse grey, {} (node {}{}): give it a material, or set "
                  "`materials.default: {{reflectance: [R, G, B]}}` in the job",
                  scene.materials[default_material].reflectance.x, fmt::join(names, ", "), more));
}

std::vector<Camera> placed_cameras(const GltfModel& model, const std::vector<PlacedNode>& nodes,
                                   const std::vector<std::string>& names, Progress& progress) {
  std::vector<Camera> cameras;
  MotionReader motions(model);
  for (const PlacedNode& node : nodes) {
    const int camera = model.gltf.nodes[node.node].camera;
    if (camera < 0) continue;
    const auto lens = model.checked.lenses.find(node.node);
    if (auto placed =
            read_camera(model.gltf.cameras[camera], lens == model.checked.lenses.end() ? GltfLens() : lens->second,
                        node.to_world, names[node.node], progress)) {
      cameras.push_back(std::move(*placed));
      cameras.back().motion = motions.motion_of(node.node);
    } else {
      progress.warning(
          fmt::format("camera '{}' is skipped: its field of view or transform is invalid", names[node.node]));
    }
  }
  return cameras;
}

}  // namespace

GltfScene read_gltf_scene(const Job& job, Progress& progress) {
  const std::vector<char> uses_uv = check_shaders(job);
  GltfReadOptions options;
  options.texcoords = std::find(uses_uv.begin(), uses_uv.end(), 1) != uses_uv.end();
  options.animations = job.import.time.has_value();
  const auto model = std::make_shared<GltfModel>(load_gltf_model(read_gltf_file(job.scene), options));
  if (job.import.time) pose_nodes(*model, *job.import.time);
  for (const std::string& message : model->checked.ignored) progress.warning(message);

  GltfScene scene;
  for (std::size_t i = 0; i < model->gltf.nodes.size(); ++i) {
    const std::string& name = model->gltf.nodes[i].name;
    scene.nodes.push_back(name.empty() ? fmt::format("node_{}", i) : name);
  }
  const std::vector<PlacedNode> nodes = placed_nodes(*model);
  scene.node_to_world.resize(scene.nodes.size());
  for (const PlacedNode& node : nodes) scene.node_to_world[node.node] = node.to_world;
  scene.surfaces = placed_surfaces(*model, nodes, triangle_limit(job.import), scene.triangles);

  remove_excluded(*model, job, scene);
  std::vector<char> used(model->gltf.materials.size() + 1, 0);
  for (const Surface& surface : scene.surfaces) used[surface.material] = 1;
  scene.materials = read_materials(*model, used, job, scene.textures, scene.masks, progress);
  remove_invisible(*model, scene, progress);
  override_nodes(*model, job, scene, progress);
  for (Surface& surface : scene.surfaces) {
    const SurfaceMaterial& material = scene.materials[surface.material];
    surface.needs_texcoords = material.has_texture() || material.mask >= 0;
  }
  assign_shaders(job, uses_uv, scene, progress);
  warn_of_missing_materials(scene, model->gltf.materials.size(), progress);
  assign_vertex_colors(*model, scene);
  LightGroups groups(*model, scene);
  mark_ray_visibility(*model, scene);
  assign_light_groups(*model, groups, scene);
  place_lights(*model, job, nodes, groups, scene, progress);
  scene.cameras = placed_cameras(*model, nodes, scene.nodes, progress);
  scene.sources = model->file.sources;
  scene.model = model;
  return scene;
}

}  // namespace patchlight
