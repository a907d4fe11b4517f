#include "importers/gltf/model/mesh_decoder.h"

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <draco/compression/mesh/mesh_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <array>
#include <cstring>

#include "importers/gltf/model/meshopt_attributes.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr std::size_t kMaxTrianglesPerByte = 1024;  // above what Draco reaches, except for huge regular grids
constexpr int kBitstream = 202;                     // version 2.2, as glTF requires

[[noreturn]] void refuse(const std::string& what, const std::string& place) {
  throw Error(ExitCode::bad_data, what, place, "the file is damaged; export the scene again");
}

/// The number of triangles in the header, which is checked before memory is allocated for them.
std::size_t header_triangles(std::span<const unsigned char> compressed, const std::string& place) {
  const char* const damaged = "the Draco data has a damaged header";
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(compressed.data()), compressed.size());
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) refuse(damaged, place);
  const int version = header.version_major * 100 + header.version_minor;
  if (header.encoder_type != draco::TRIANGULAR_MESH) refuse("the Draco data is not a mesh", place);
  if (version != kBitstream) {
    refuse(fmt::format("the Draco version {}.{} is not 2.2, as glTF requires", int(header.version_major),
                       int(header.version_minor)),
           place);
  }
  buffer.set_bitstream_version(
      static_cast<std::uint16_t>(DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor)));
  if (header.flags & METADATA_FLAG_MASK) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) refuse(damaged, place);
  }
  std::uint32_t faces = 0;
  std::uint32_t vertices = 0;
  std::uint8_t traversal = 0;
  const bool edgebreaker = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING;
  const bool read = edgebreaker ? buffer.Decode(&traversal) && draco::DecodeVarint(&vertices, &buffer) &&
                                      draco::DecodeVarint(&faces, &buffer)
                                : draco::DecodeVarint(&faces, &buffer) && draco::DecodeVarint(&vertices, &buffer);
  if (!read || vertices / 3 > faces) refuse(damaged, place);
  return faces;
}

template <class Number>
bool convert(const draco::Mesh& mesh, const draco::PointAttribute& source, int components, Bytes& bytes) {
  const std::size_t size = sizeof(Number) * static_cast<std::size_t>(components);
  bytes.resize(size * mesh.num_points());
  std::vector<Number> value(static_cast<std::size_t>(components));
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex at = source.mapped_index(draco::PointIndex(i));
    if (at.value() >= source.size()) return false;
    if (!source.ConvertValue<Number>(at, static_cast<std::int8_t>(components), value.data())) return false;
    std::memcpy(bytes.data() + i * size, value.data(), size);
  }
  return true;
}

bool convert(const draco::Mesh& mesh, const draco::PointAttribute& source, DracoAttribute& attribute) {
  const int n = attribute.components;
  switch (attribute.component_type) {
    case 5120:
      return convert<std::int8_t>(mesh, source, n, attribute.bytes);
    case 5121:
      return convert<std::uint8_t>(mesh, source, n, attribute.bytes);
    case 5122:
      return convert<std::int16_t>(mesh, source, n, attribute.bytes);
    case 5123:
      return convert<std::uint16_t>(mesh, source, n, attribute.bytes);
    case 5125:
      return convert<std::uint32_t>(mesh, source, n, attribute.bytes);
    default:
      return convert<float>(mesh, source, n, attribute.bytes);
  }
}

/// Half a quantization step; 0 for values that are not quantized.
double rounding_of(const draco::PointAttribute& attribute) {
  draco::AttributeQuantizationTransform transform;
  if (!attribute.GetAttributeTransformData() || !transform.InitFromAttribute(attribute)) return 0.0;
  return 0.5 * static_cast<double>(transform.range()) / ((1 << transform.quantization_bits()) - 1);
}

bool decode_filter(const MeshoptView& view, Bytes& bytes) {
  unsigned char* const elements = bytes.data();
  switch (view.filter) {
    case MeshoptView::Filter::octahedral:
      meshopt_decodeFilterOct(elements, view.count, view.stride);
      return true;
    case MeshoptView::Filter::quaternion:
      meshopt_decodeFilterQuat(elements, view.count, view.stride);
      return true;
    case MeshoptView::Filter::exponential:
      meshopt_decodeFilterExp(elements, view.count, view.stride);
      return true;
    case MeshoptView::Filter::color:
      return decode_colors(view, bytes);
    case MeshoptView::Filter::none:
      return true;
  }
  return false;
}

}  // namespace

bool decode_meshopt(const MeshoptView& view, std::span<const unsigned char> compressed, Bytes& elements) {
  elements.resize(view.count * view.stride);
  if (view.count == 0) return true;
  const auto decompress = [&](int (*decode)(void*, std::size_t, std::size_t, const unsigned char*, std::size_t)) {
    return decode(elements.data(), view.count, view.stride, compressed.data(), compressed.size()) == 0;
  };
  switch (view.mode) {
    case MeshoptView::Mode::attributes:
      return (is_attributes_version_1(compressed) ? decode_attributes_version_1(view, compressed, elements)
                                                  : decompress(meshopt_decodeVertexBuffer)) &&
             decode_filter(view, elements);
    case MeshoptView::Mode::triangles:
      return decompress(meshopt_decodeIndexBuffer);
    case MeshoptView::Mode::indices:
      return decompress(meshopt_decodeIndexSequence);
  }
  return false;
}

void decode_draco(std::span<const unsigned char> compressed, const std::string& place, DracoMesh& mesh) {
  const std::size_t triangles = header_triangles(compressed, place);
  if (triangles != mesh.triangles || triangles > kMaxTrianglesPerByte * compressed.size()) {
    refuse(fmt::format("the Draco data has {} triangles in {} bytes, but the accessor has {}", triangles,
                       compressed.size(), mesh.triangles),
           place);
  }
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(compressed.data()), compressed.size());
  draco::Decoder decoder;
  const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) refuse(fmt::format("the Draco data is damaged: {}", decoded.status().error_msg()), place);
  const draco::Mesh& source = *decoded.value();
  mesh.vertices = source.num_points();
  for (DracoAttribute& attribute : mesh.attributes) {
    const draco::PointAttribute* values = source.GetAttributeByUniqueId(static_cast<std::uint32_t>(attribute.id));
    if (!values || !convert(source, *values, attribute)) {
      refuse(fmt::format("the Draco data has no {} attribute of the accessor's type", attribute.name), place);
    }
    attribute.rounding = rounding_of(*values);
  }
  mesh.triangles = source.num_faces();
  mesh.indices.resize(mesh.triangles * 3 * sizeof(std::uint32_t));
  for (std::uint32_t i = 0; i < source.num_faces(); ++i) {
    const draco::Mesh::Face& face = source.face(draco::FaceIndex(i));
    const std::array<std::uint32_t, 3> corners{face[0].value(), face[1].value(), face[2].value()};
    std::memcpy(mesh.indices.data() + i * sizeof(corners), corners.data(), sizeof(corners));
  }
}

}  // namespace patchlight
