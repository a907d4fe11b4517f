#include "importers/gltf/read/instances.h"

#include <ImathQuat.h>
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "importers/gltf/model/accessor.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

std::optional<AccessorReader> reader_of(const GltfModel& model, const GltfInstances& instances, const char* key) {
  const auto accessor = instances.attributes.find(key);
  if (accessor == instances.attributes.end()) return std::nullopt;
  return AccessorReader(model, accessor->second);
}

}  // namespace

std::vector<Matrix4> instances_of(const GltfModel& model, int node) {
  const auto found = model.checked.instances.find(node);
  if (found == model.checked.instances.end()) return {Matrix4()};
  const auto translation = reader_of(model, found->second, "TRANSLATION");
  const auto rotation = reader_of(model, found->second, "ROTATION");
  const auto scale = reader_of(model, found->second, "SCALE");
  std::vector<Matrix4> result;
  for (std::size_t i = 0; i < found->second.count; ++i) {
    Matrix4 matrix;
    if (scale) matrix.setScale(Vec3d(scale->vector3(i)));
    if (rotation) {
      const auto q = rotation->vector4(i);
      const Imath::Quatd quaternion(q[3], q[0], q[1], q[2]);
      if (quaternion.length() > 0.0) matrix *= quaternion.normalized().toMatrix44();
    }
    if (translation) matrix *= Matrix4().setTranslation(Vec3d(translation->vector3(i)));
    for (int k = 0; k < 16; ++k) {
      if (!std::isfinite(matrix.x[k / 4][k % 4])) {
        throw Error(ExitCode::bad_data, fmt::format("instance {} is not finite", i),
                    fmt::format("{}, nodes[{}] '{}'", model.file.name, node, model.gltf.nodes[node].name),
                    "correct the instance's transform");
      }
    }
    result.push_back(matrix);
  }
  return result;
}

}  // namespace patchlight
