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

/// All triangles of one node that share a material.
struct Surface {
  int node = 0;
  int material = 0;      ///< Index into GltfScene::materials.
  int light_group = -1;  ///< Index into GltfScene::light_groups; -1: it does not emit.
  Matrix4 to_world;
  int mesh = 0;
  int part = 0;               ///< Of the mesh.
  int shader = -1;            ///< Index into GltfScene::shaders; -1: none.
  bool reads_uv = false;      ///< Its texture, or its shader, reads texture coordinates.
  bool reads_colors = false;  ///< Its vertices have colours that count;
  bool reads_alphas = false;  ///< or alpha.
  bool is_masked = false;     ///< Its material cuts something out of it.
};

/// What the importer takes from a glTF file. Triangles are read surface by surface, since instances can make a small
/// file a large scene.
struct GltfScene {
  std::vector<std::string> nodes;  ///< All nodes of the file; `node_N` for one without a name.
  std::vector<SurfaceMaterial> materials;
  std::vector<std::string> light_groups;
  std::vector<Shader> shaders;
  std::vector<Texture> textures;
  std::vector<Texture> masks;
  std::vector<Surface> surfaces;
  std::vector<Matrix4> node_to_world;  ///< By node; what is not in the scene stands at the origin.
  std::vector<Light> lights;
  std::vector<Camera> cameras;  ///< None is made up here.
  std::vector<SourceFile> sources;
  std::int64_t triangles = 0;  ///< Over all surfaces.
  std::shared_ptr<const GltfModel> model;
};

/// Reads the job's scene: the nodes of the default scene, or all where it has none, in their rest state or as
/// they stand at import.time.
/// Throws: Error (missing_input, bad_data); (bad_config) for a shader that does not compile; (over_limit) where
/// instances make too many triangles; (io_error).
GltfScene read_gltf_scene(const Job& job, Progress& progress);

/// The world-space triangles of a surface, with texture coordinates if its shader reads them; windings are turned where
/// the node's transform mirrors.
/// Throws: Error (bad_data) naming the node for numbers that are not finite and for indices out of range.
TriangleSoup read_triangles(const GltfScene& scene, const Surface& surface);

}  // namespace patchlight
