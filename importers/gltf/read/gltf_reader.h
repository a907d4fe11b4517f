#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "importers/mesh/surface.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

struct GltfModel;

/// All triangles of one node, or of one of its instances, that share a material.
struct Surface {
  int node = 0;
  int material = 0;      ///< Index into GltfScene::materials.
  int light_group = -1;  ///< Index into GltfScene::light_groups; -1: it does not emit.
  Matrix4 to_world;
  int mesh = 0;
  int part = 0;                  ///< Index into GltfModel::mesh_parts[mesh].
  int shader = -1;               ///< Index into GltfScene::shaders; -1: none.
  bool needs_texcoords = false;  ///< A texture, a mask or its shader uses texture coordinates.
  bool needs_colors = false;     ///< Vertex colours apply.
  bool needs_alphas = false;     ///< Vertex alpha applies.
  bool is_masked = false;        ///< An alpha mask applies.
};

/// Imported contents of a glTF file, except triangles: these are read surface by surface, since instances can make a
/// scene much larger than its file.
struct GltfScene {
  std::vector<std::string> nodes;        ///< All nodes of the file; `node_N` for one without a name.
  std::vector<std::int32_t> unseen;      ///< As in PatchSet.
  std::vector<std::int32_t> intangible;  ///< By node: whether it asks for Primitive::intangible; empty: none does.
  std::vector<SurfaceMaterial> materials;
  std::vector<std::string> light_groups;
  std::vector<Shader> shaders;
  std::vector<Texture> textures;
  std::vector<Texture> masks;
  std::vector<Surface> surfaces;
  std::vector<Matrix4> node_to_world;  ///< By node; identity for nodes outside of the scene.
  std::vector<Light> lights;
  std::vector<LightDistribution> distributions;
  std::vector<Camera> cameras;  ///< Empty if the file has none.
  std::vector<SourceFile> sources;
  std::int64_t triangles = 0;  ///< Of all surfaces.
  std::shared_ptr<const GltfModel> model;
};

/// Reads the job's scene: the nodes of the default scene, or all nodes if the file has no scene, in their rest pose or
/// as animated at import.time.
/// Throws: Error (missing_input, bad_data); (bad_config) for a shader that does not compile; (over_limit) for
/// too many triangles or lights; (io_error).
GltfScene read_gltf_scene(const Job& job, Progress& progress);

/// The triangles of a surface in world space, with the vertex attributes it needs. The winding is reversed where the
/// transform mirrors. Throws: Error (bad_data) naming the node for non-finite numbers and indices out of range.
TriangleSoup read_triangles(const GltfScene& scene, const Surface& surface);

}  // namespace patchlight
