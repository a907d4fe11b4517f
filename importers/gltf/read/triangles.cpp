#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "importers/gltf/model/accessor.h"
#include "importers/gltf/read/gltf_reader.h"
#include "importers/gltf/read/rest_pose.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr double kFloatRounding = 0x1p-24;  // relative error of a float
constexpr double kMaxDistance = 1e12;       // m; beyond, positions lose precision and areas overflow
const Vec2f kNoTexcoord(std::numeric_limits<float>::quiet_NaN());

/// A node's transform, for positions and for normals.
struct Placement {
  Matrix4 matrix;
  std::array<Vec3d, 3> cofactors;  ///< Rows of the cofactor matrix, which transforms normals up to their length.
  bool mirrors = false;

  explicit Placement(const Matrix4& to_world) : matrix(to_world) {
    const Vec3d x(matrix[0][0], matrix[0][1], matrix[0][2]);
    const Vec3d y(matrix[1][0], matrix[1][1], matrix[1][2]);
    const Vec3d z(matrix[2][0], matrix[2][1], matrix[2][2]);
    mirrors = x.dot(y.cross(z)) < 0.0;
    const double sign = mirrors ? -1.0 : 1.0;
    cofactors = {sign * y.cross(z), sign * z.cross(x), sign * x.cross(y)};
  }

  /// Upper bound of the factor by which lengths grow.
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

/// Order of the triangles' corners in a mesh primitive of any mode.
struct CornerOrder {
  int mode;

  /// Position of a triangle's corner in the index list.
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

/// Vertex attributes to read besides positions and normals.
struct RequestedAttributes {
  std::vector<TextureMapping> mappings{};  ///< Of texture coordinates; empty: none.
  bool colors = false;
  bool alphas = false;
};

/// Accessors of a mesh primitive; absent ones are empty.
struct PrimitiveAccessors {
  AccessorReader positions;
  std::optional<AccessorReader> normals{};
  std::optional<AccessorReader> indices{};
  std::optional<AccessorReader> colors{};
  std::vector<std::optional<AccessorReader>> texcoords{};  ///< By mapping.

  PrimitiveAccessors(const GltfModel& model, const tinygltf::Primitive& primitive, const RequestedAttributes& requested)
      : positions(model, primitive.attributes.at("POSITION")), texcoords(requested.mappings.size()) {
    const auto read = [&](const std::string& name, std::optional<AccessorReader>& reader) {
      const auto attribute = primitive.attributes.find(name);
      if (attribute != primitive.attributes.end()) reader.emplace(model, attribute->second);
    };
    read("NORMAL", normals);
    if (primitive.indices >= 0) indices.emplace(model, primitive.indices);
    if (requested.colors || requested.alphas) read("COLOR_0", colors);
    for (std::size_t k = 0; k < texcoords.size(); ++k)
      read(fmt::format("TEXCOORD_{}", requested.mappings[k].set), texcoords[k]);
  }
};

/// Appends the triangles of one mesh primitive to a soup, in world space.
class TriangleReader {
 public:
  /// `place`: the node, for errors.
  TriangleReader(const PrimitiveAccessors& accessors, const Placement& placement, const RestPose& pose,
                 const RequestedAttributes& requested, std::string place, TriangleSoup& soup)
      : accessors_(accessors),
        placement_(placement),
        pose_(pose),
        requested_(requested),
        place_(std::move(place)),
        soup_(soup) {}

  void append_triangles(int mode) {
    const CornerOrder order{mode};
    const std::size_t count =
        order.triangles(accessors_.indices ? accessors_.indices->count : accessors_.positions.count);
    for (std::size_t triangle = 0; triangle < count; ++triangle) {
      bool mirrors = placement_.mirrors;
      if (pose_.has_skin()) mirrors = Placement(pose_.to_world(vertex_at(order(triangle, 0)))).mirrors;
      for (std::size_t i = 0; i < 3; ++i) append_vertex(vertex_at(order(triangle, mirrors && i > 0 ? 3 - i : i)));
    }
    update_rounding();
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ExitCode::bad_data, what, place_, "correct its mesh and export the scene again");
  }

  std::size_t vertex_at(std::size_t corner) const {
    const std::size_t vertex = accessors_.indices ? accessors_.indices->index(corner) : corner;
    const std::size_t count = accessors_.positions.count;
    if (vertex >= count)
      refuse(fmt::format("index {} refers to a vertex that does not exist; there are {}", vertex, count));
    return vertex;
  }

  void append_vertex(std::size_t vertex) {
    std::optional<Placement> skinned;
    const Placement& placement = pose_.has_skin() ? skinned.emplace(pose_.to_world(vertex)) : placement_;
    const Vec3f local = pose_.morphed_position(vertex, accessors_.positions.vector3(vertex));
    largest_ = std::max({largest_, std::abs(local.x), std::abs(local.y), std::abs(local.z)});
    const Vec3d position = placement.position(local);
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(position[axis])) refuse("a position is not finite");
      if (std::abs(position[axis]) > kMaxDistance) refuse(fmt::format("a position is beyond {} m", kMaxDistance));
    }
    soup_.positions.push_back(position);
    append_normal(vertex, placement);
    if (requested_.colors || requested_.alphas) append_color(vertex);
    append_texcoords(vertex);
  }

  void append_normal(std::size_t vertex, const Placement& placement) {
    constexpr float kMinLength = 0.5f, kMaxLength = 2.0f;
    Vec3f& result = soup_.normals.emplace_back(0.0f);
    const std::optional<AccessorReader>& normals = accessors_.normals;
    if (!normals || !normals->data) return;
    const Vec3f local = normals->vector3(vertex);
    if (local.length() >= kMinLength && local.length() <= kMaxLength)
      result = placement.normal(pose_.morphed_normal(vertex, local));
    else
      ++soup_.invalid_normals;
  }

  void append_color(std::size_t vertex) {
    Vec4f value(1.0f);
    if (accessors_.colors) {
      const AccessorReader& colors = *accessors_.colors;
      const Vec3f color = colors.data ? colors.vector3(vertex) : Vec3f(0.0f);
      if (requested_.colors) value = Vec4f(color.x, color.y, color.z, 1.0f);
      if (requested_.alphas && colors.components == 4) value.w = colors.data ? colors.vector4(vertex)[3] : 0.0f;
    }
    soup_.colors.push_back(value);
    for (int k = 0; k < 4; ++k)
      if (!(value[k] >= 0.0f && value[k] <= 1.0f))
        refuse(fmt::format("a vertex colour of {} is not in [0, 1]", value[k]));
  }

  void append_texcoords(std::size_t vertex) {
    for (std::size_t k = 0; k < accessors_.texcoords.size(); ++k) {
      const std::optional<AccessorReader>& texcoords = accessors_.texcoords[k];
      const bool has = texcoords && texcoords->data;
      soup_.texcoords[k].push_back(has ? requested_.mappings[k](texcoords->vector2(vertex)) : kNoTexcoord);
      if (has && !std::isfinite(soup_.texcoords[k].back().x + soup_.texcoords[k].back().y))
        refuse("a texture coordinate is not finite");
    }
  }

  void update_rounding() {
    const AccessorReader& positions = accessors_.positions;
    const double rounding = std::max(positions.rounding, kFloatRounding * static_cast<double>(largest_));
    soup_.rounding = std::max(soup_.rounding, rounding * placement_.scale());
    soup_.quantized = soup_.quantized || positions.rounding > 0.0;
    for (std::size_t k = 0; k < accessors_.texcoords.size(); ++k) {
      if (!accessors_.texcoords[k]) continue;
      const Vec2f& scale = requested_.mappings[k].scale;
      const double largest = std::max(std::abs(scale.x), std::abs(scale.y));
      soup_.texcoord_rounding = std::max(soup_.texcoord_rounding, accessors_.texcoords[k]->rounding * largest);
    }
  }

  const PrimitiveAccessors& accessors_;
  const Placement& placement_;
  const RestPose& pose_;
  const RequestedAttributes& requested_;
  const std::string place_;
  TriangleSoup& soup_;
  float largest_ = 0.0f;  ///< Largest |coordinate| in mesh space.
};

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
  RequestedAttributes requested{{}, surface.needs_colors, surface.needs_alphas};
  if (surface.needs_texcoords) requested.mappings = scene.materials[surface.material].mappings().all;
  soup.texcoords.resize(requested.mappings.size());
  const tinygltf::Mesh& mesh = model.gltf.meshes[surface.mesh];
  const tinygltf::Node& node = model.gltf.nodes[surface.node];
  std::vector<Matrix4> joints;
  if (node.skin >= 0) joints = joint_matrices(model, node.skin, scene.node_to_world);
  const std::string place = fmt::format("{}, node '{}'", model.file.name, scene.nodes[surface.node]);
  for (const int index : part.primitives) {
    const tinygltf::Primitive& primitive = mesh.primitives[index];
    const RestPose pose(model, primitive, node.weights.empty() ? mesh.weights : node.weights, joints);
    const PrimitiveAccessors accessors(model, primitive, requested);
    TriangleReader(accessors, placement, pose, requested, place, soup).append_triangles(primitive.mode);
  }
  return soup;
}

}  // namespace patchlight
