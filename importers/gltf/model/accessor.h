#pragma once
// Internal to the glTF files of this folder: brings tinygltf along.
#include <array>

#include "importers/gltf/model/gltf_model.h"

namespace patchlight {

/// Reads elements of a checked accessor, at any alignment, quantized or normalized.
struct AccessorReader {
  /// Throws: Error (bad_data) if its buffer has no data.
  AccessorReader(const GltfModel& model, int accessor);

  std::size_t count = 0;
  int components = 1;                   ///< Of an element.
  const unsigned char* data = nullptr;  ///< Null: all elements are zeros.

  double rounding = 0.0;  ///< How far off a quantized number may be.

  std::uint32_t index(std::size_t element) const;
  /// Of keyframes, whose integers are always normalized.
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

std::uint32_t unsigned_at(const unsigned char* at, int component_type);
std::size_t size_of(int component_type);

}  // namespace patchlight
