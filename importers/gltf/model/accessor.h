#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <array>

#include "importers/gltf/model/gltf_model.h"

namespace patchlight {

/// Reads elements of a checked accessor of any alignment and component type.
struct AccessorReader {
  /// Throws: Error (bad_data) if the accessor's buffer has no data.
  AccessorReader(const GltfModel& model, int accessor);

  std::size_t count = 0;
  int components = 1;                   ///< Per element.
  const unsigned char* data = nullptr;  ///< Null: all elements are zero.

  double rounding = 0.0;  ///< Largest error of a quantized component; 0 for floats.

  std::uint32_t index(std::size_t element) const;
  /// Component of a keyframe; integers are always read as normalized.
  float component(std::size_t element, std::size_t number) const;
  Vec2f vector2(std::size_t element) const;
  Vec3f vector3(std::size_t element) const;
  std::array<float, 4> vector4(std::size_t element) const;
  Imath::M44f matrix(std::size_t element) const;

 private:
  template <std::size_t N>
  std::array<float, N> numbers(std::size_t element) const;

  int component_type_ = 0;
  bool normalized_ = false;
  std::size_t stride_ = 0;
};

/// An unsigned integer of a glTF component type, at any alignment.
std::uint32_t unsigned_at(const unsigned char* at, int component_type);

/// Bytes of a component.
std::size_t size_of(int component_type);

}  // namespace patchlight
