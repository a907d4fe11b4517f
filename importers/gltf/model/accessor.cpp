#include "importers/gltf/model/accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace patchlight {
namespace {

template <class Number>
Number number_at(const unsigned char* at) {
  Number value{};
  std::memcpy(&value, at, sizeof(value));
  return value;
}

double max_of(int component_type) {
  if (component_type == TINYGLTF_COMPONENT_TYPE_BYTE) return 127.0;
  if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return 255.0;
  return component_type == TINYGLTF_COMPONENT_TYPE_SHORT ? 32767.0 : 65535.0;
}

template <class Integer>
float to_float(const unsigned char* at, bool normalized) {
  const auto value = static_cast<float>(number_at<Integer>(at));
  return normalized ? std::max(value / static_cast<float>(std::numeric_limits<Integer>::max()), -1.0f) : value;
}

}  // namespace

std::uint32_t unsigned_at(const unsigned char* at, int component_type) {
  if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *at;
  if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return number_at<std::uint16_t>(at);
  return number_at<std::uint32_t>(at);
}

std::size_t size_of(int component_type) {
  return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type)));
}

AccessorReader::AccessorReader(const GltfModel& model, int accessor) {
  const tinygltf::Accessor& source = model.gltf.accessors[accessor];
  count = source.count;
  component_type_ = source.componentType;
  normalized_ = source.normalized;
  components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(source.type));
  const std::size_t size = size_of(component_type_) * static_cast<std::size_t>(components);
  stride_ = size;
  const bool quantized = component_type_ != TINYGLTF_COMPONENT_TYPE_FLOAT;
  if (quantized) rounding = normalized_ ? 0.5 / max_of(component_type_) : 0.5;
  const auto quantized_by_draco = model.roundings.find(accessor);
  if (quantized_by_draco != model.roundings.end()) rounding = quantized_by_draco->second;
  if (source.bufferView >= 0 && count > 0) {
    const tinygltf::BufferView& view = model.gltf.bufferViews[source.bufferView];
    data = view_bytes(model, source.bufferView).data() + source.byteOffset;
    if (view.byteStride > 0) stride_ = view.byteStride;
  }
}

std::uint32_t AccessorReader::index(std::size_t element) const {
  return unsigned_at(data + element * stride_, component_type_);
}

template <std::size_t N>
std::array<float, N> AccessorReader::numbers(std::size_t element) const {
  std::array<float, N> result{};
  const unsigned char* const at = data + element * stride_;
  const auto convert = [&]<class Integer>(Integer) {
    for (std::size_t i = 0; i < N; ++i) result[i] = to_float<Integer>(at + i * sizeof(Integer), normalized_);
  };
  switch (component_type_) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      convert(std::int8_t{});
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      convert(std::uint8_t{});
      break;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      convert(std::int16_t{});
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      convert(std::uint16_t{});
      break;
    default:
      std::memcpy(result.data(), at, sizeof(result));
  }
  return result;
}

float AccessorReader::component(std::size_t element, std::size_t number) const {
  const unsigned char* const at = data + element * stride_ + number * size_of(component_type_);
  switch (component_type_) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return to_float<std::int8_t>(at, true);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return to_float<std::uint8_t>(at, true);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return to_float<std::int16_t>(at, true);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return to_float<std::uint16_t>(at, true);
    default:
      return number_at<float>(at);
  }
}

Vec2f AccessorReader::vector2(std::size_t element) const {
  const auto value = numbers<2>(element);
  return {value[0], value[1]};
}

Vec3f AccessorReader::vector3(std::size_t element) const {
  const auto value = numbers<3>(element);
  return {value[0], value[1], value[2]};
}

std::array<float, 4> AccessorReader::vector4(std::size_t element) const {
  return numbers<4>(element);
}

/// glTF's column-major matrices for column vectors equal Imath's row-major matrices for row vectors.
Imath::M44f AccessorReader::matrix(std::size_t element) const {
  const auto value = numbers<16>(element);
  Imath::M44f result;
  std::copy(value.begin(), value.end(), &result.x[0][0]);
  return result;
}

}  // namespace patchlight
