#include "tests/importers/draco_packer.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

namespace patchlight::test {

DracoBytes draco_packed(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices, int bits) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(int(indices.size() / 3));
  const int attribute = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return &positions[indices[i + k]].x; };
    builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(std::uint32_t(i / 3)), corner(0), corner(1),
                                      corner(2));
  }
  draco::Encoder encoder;
  encoder.SetTrackEncodedProperties(true);
  if (bits > 0) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
  draco::EncoderBuffer buffer;
  const auto mesh = builder.Finalize();
  if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) return {};
  return {{buffer.data(), buffer.size()}, encoder.num_encoded_points()};
}

}  // namespace patchlight::test
