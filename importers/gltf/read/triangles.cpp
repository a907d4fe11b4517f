#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "importers/gltf/model/accessor.h"
#include "importers/gltf/read/gltf_reader.h"
#include "importers/gltf/read/rest_pose.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr double kFloatRounding = 0x1p-24;  // of a number, in its size
constexpr double kFarthest = 1e12;          // m; what is farther has no useful digits left and overflows areas
const Vec2f kNoTexcoord(std::numeric_limits<float>::quiet_NaN());

/// A node's transform, for positions and for normals.
struct Placement {
  Matrix4 matrix;
  std::array<Vec3d, 3> cofactors;  ///< Rows; takes normals along, up to their length.
  bool mirrors = false;

  explicit Placement(const Matrix4& to_world) : matrix(to_world) {
    const Vec3d x(matrix[0][0], matrix[0][1], matrix[0][2]);
    const Vec3d y(matrix[1][0], matrix[1][1], matrix[1][2]);
    const Vec3d z(matrix[2][0], matrix[2][1], matrix[2][2]);
    mirrors = x.dot(y.cross(z)) < 0.0;
    const double sign = mirrors ? -1.0 : 1.0;
    cofactors = {sign * y.cross(z), sign * z.cross(x), sign * x.cross(y)};
  }

  /// The most by which a length can grow.
  double scale() const {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += Vec3d(matrix[i][0], matrix[i][1], matrix[i][2]).length2();
    return std::sqrt(sum);
  }

  Vec3d position(const Vec3f& local) const {
    const Vec3d p(local);
    Vec3d world;
    for (int i = 0; i < 3; ++i) {
      world[i] = p.x * matrix[0][i] + p.y * matrix[1][i] + p.z * matrix[2][i] + matrix[3][i];
    }
    return world;
  }

  Vec3f normal(const Vec3f& local) const {
    const Vec3d world = static_cast<double>(local.x) * cofactors[0] + static_cast<double>(local.y) * cofactors[1] +
                        static_cast<double>(local.z) * cofactors[2];
    const double length = world.length();
    return length > 0.0 && std::isfinite(length) ? Vec3f(world / length) : Vec3f(0.0f);
  }
};

/// The corner indices of one mesh primitive's triangles, whatever its mode.
struct CornerOrder {
  int mode;

  /// The place in the index list of a triangle's corner.
  std::size_t operator()(std::size_t triangle, std::size_t corner) const {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return corner == 0 ? 0 : triangle + corner;
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      const bool odd = triangle % 2 == 1;
      return triangle + (odd && corner > 0 ? 3 - corner : corner);
    }
    return 3 * triangle + corner;
  }

  std::size_t triangles(std::size_t indices) const {
    if (mode == TINYGLTF_MODE_TRIANGLES) return indices / 3;
    return indices < 3 ? 0 : indices - 2;
  }
};

/// What of a mesh primitive's vertices is read besides their places.
struct Wanted {
  std::vector<TextureMapping> mappings{};  ///< Of texture coordinates; empty: none.
  bool colors = false;
  bool alphas = false;
};

/// The colour of a vertex and its alpha, as far as they are wanted.
Vec4f color_at(const std::optional<AccessorReader>& colors, const Wanted& wanted, std::size_t vertex) {
  Vec4f value(1.0f);
  if (!colors) return value;
  const Vec3f color = colors->data ? colors->vector3(vertex) : Vec3f(0.0f);
  if (wanted.colors) value = Vec4f(color.x, color.y, color.z, 1.0f);
  if (wanted.alphas && colors->components == 4) value.w = colors->data ? colors->vector4(vertex)[3] : 0.0f;
  return value;
}

void append_triangles(const GltfModel& model, const tinygltf::Primitive& primitive, const Placement& placement,
                      const RestPose& pose, const std::string& node, const Wanted& wanted, TriangleSoup& soup) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ExitCode::bad_data, what, fmt::format("{}, node '{}'", model.file.name, node), "mend its mesh");
  };
  const AccessorReader positions(model, primitive.attributes.at("POSITION"));
  std::optional<AccessorReader> normals;
  std::optional<AccessorReader> indices;
  std::vector<std::optional<AccessorReader>> uvs(wanted.mappings.size());
  std::optional<AccessorReader> colors;
  const auto normal = primitive.attributes.find("NORMAL");
  if (normal != primitive.attributes.end()) normals.emplace(model, normal->second);
  if (primitive.indices >= 0) indices.emplace(model, primitive.indices);
  const auto color = primitive.attributes.find("COLOR_0");
  if ((wanted.colors || wanted.alphas) && color != primitive.attributes.end()) colors.emplace(model, color->second);
  for (std::size_t k = 0; k < uvs.size(); ++k) {
    const auto uv = primitive.attributes.find(fmt::format("TEXCOORD_{}", wanted.mappings[k].set));
    if (uv != primitive.attributes.end()) uvs[k].emplace(model, uv->second);
  }

  std::optional<Placement> bent;
  const CornerOrder order{primitive.mode};
  const std::size_t count = order.triangles(indices ? indices->count : positions.count);
  float largest = 0.0f;  // coordinate
  const auto vertex_at = [&](std::size_t corner) {
    const std::size_t vertex = indices ? indices->index(corner) : corner;
    if (vertex >= positions.count) refuse(fmt::format("vertex {} of {} does not exist", vertex, positions.count));
    return vertex;
  };
  for (std::size_t triangle = 0; triangle < count; ++triangle) {
    bool mirrors = placement.mirrors;
    if (pose.has_skin()) mirrors = Placement(pose.to_world(vertex_at(order(triangle, 0)))).mirrors;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t vertex = vertex_at(order(triangle, mirrors && i > 0 ? 3 - i : i));
      const Placement& placed = pose.has_skin() ? bent.emplace(pose.to_world(vertex)) : placement;
      const Vec3f local = pose.morphed_position(vertex, positions.vector3(vertex));
      largest = std::max({largest, std::abs(local.x), std::abs(local.y), std::abs(local.z)});
      const Vec3d position = placed.position(local);
      for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(position[axis])) refuse("a position is not finite");
        if (std::abs(position[axis]) > kFarthest) refuse(fmt::format("a position is beyond {} m", kFarthest));
      }
      soup.positions.push_back(position);
      soup.normals.push_back(normals && normals->data
                                 ? placed.normal(pose.morphed_normal(vertex, normals->vector3(vertex)))
                                 : Vec3f(0.0f));
      if (wanted.colors || wanted.alphas) {
        const Vec4f value = color_at(colors, wanted, vertex);
        soup.colors.push_back(value);
        for (int k = 0; k < 4; ++k)
          if (!(value[k] >= 0.0f && value[k] <= 1.0f))
            refuse(fmt::format("a vertex colour of {} is not in [0, 1]", value[k]));
      }
      for (std::size_t k = 0; k < uvs.size(); ++k) {
        const bool has = uvs[k] && uvs[k]->data;
        soup.texcoords[k].push_back(has ? wanted.mappings[k](uvs[k]->vector2(vertex)) : kNoTexcoord);
        if (has && !std::isfinite(soup.texcoords[k].back().x + soup.texcoords[k].back().y))
          refuse("a texture coordinate is not finite");
      }
    }
  }
  const double rounding = std::max(positions.rounding, kFloatRounding * static_cast<double>(largest));
  soup.rounding = std::max(soup.rounding, rounding * placement.scale());
  soup.quantized = soup.quantized || positions.rounding > 0.0;
  for (std::size_t k = 0; k < uvs.size(); ++k) {
    if (!uvs[k]) continue;
    const Vec2f& stretch = wanted.mappings[k].scale;
    const double most = std::max(std::abs(stretch.x), std::abs(stretch.y));
    soup.texcoord_rounding = std::max(soup.texcoord_rounding, uvs[k]->rounding * most);
  }
}

}  // namespace

Vec2f TextureMapping::operator()(const Vec2f& uv) const {
  if (rotation == 0.0f) return uv * scale + offset;
  const Vec2f scaled = uv * scale;
  const float c = std::cos(rotation), s = std::sin(rotation);
  return Vec2f(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x) + offset;
}

TriangleSoup read_triangles(const GltfScene& scene, const Surface& surface) {
  const GltfModel& model = *scene.model;
  const MeshPart& part = model.mesh_parts[surface.mesh][surface.part];
  TriangleSoup soup;
  soup.positions.reserve(static_cast<std::size_t>(part.triangles) * 3);
  soup.normals.reserve(static_cast<std::size_t>(part.triangles) * 3);
  const Placement placement(surface.to_world);
  Wanted wanted{{}, surface.reads_colors, surface.reads_alphas};
  if (surface.reads_uv) wanted.mappings = scene.materials[surface.material].mappings().all;
  soup.texcoords.resize(wanted.mappings.size());
  const tinygltf::Mesh& mesh = model.gltf.meshes[surface.mesh];
  const tinygltf::Node& node = model.gltf.nodes[surface.node];
  std::vector<Matrix4> joints;
  if (node.skin >= 0) joints = joint_matrices(model, node.skin, scene.node_to_world);
  for (const int primitive : part.primitives) {
    const RestPose pose(model, mesh.primitives[primitive], node.weights.empty() ? mesh.weights : node.weights, joints);
    append_triangles(model, mesh.primitives[primitive], placement, pose, scene.nodes[surface.node], wanted, soup);
  }
  return soup;
}

}  // namespace patchlight
