#include "pipeline/files/patch_textures.h"

#include <algorithm>

namespace patchlight {

namespace {

constexpr int kColumns = 5;  // width, height, wraps, nearest
const char* const kShapes = "/textures/shape";

Texture::Wrap wrap_of(const H5Reader& reader, std::int32_t value) {
  if (value < 0 || value > 2) reader.refuse("an unknown wrap", kShapes);
  return Texture::Wrap(value);
}

void read_textures(const H5Reader& reader, std::vector<Texture>& textures) {
  const std::vector<std::int32_t> shapes = reader.dataset<std::int32_t>(kShapes, -1, kColumns);
  const std::vector<std::int32_t> texels = reader.dataset<std::int32_t>("/textures/texel", -1);
  std::size_t next = 0;
  for (std::size_t k = 0; k < shapes.size(); k += kColumns) {
    const std::int64_t width = shapes[k], height = shapes[k + 1];
    if (width < 1 || height < 1 || width * height > std::int64_t(texels.size() - next))
      reader.refuse("a size that does not fit the texels", kShapes);
    const auto first = texels.begin() + std::ptrdiff_t(next);
    textures.push_back({shapes[k],
                        shapes[k + 1],
                        {wrap_of(reader, shapes[k + 2]), wrap_of(reader, shapes[k + 3])},
                        shapes[k + 4] != 0,
                        {first, first + width * height}});
    next += std::size_t(width * height);
  }
}

}  // namespace

void write_texture_datasets(H5Writer& writer, const PatchSet& scene) {
  if (!scene.textures.empty()) {
    std::vector<std::int32_t> shapes, texels, assigned;
    for (const Texture& t : scene.textures) {
      shapes.insert(shapes.end(), {t.width, t.height, std::int32_t(t.wrap[0]), std::int32_t(t.wrap[1]), t.nearest});
      texels.insert(texels.end(), t.texels.begin(), t.texels.end());
    }
    for (const Primitive& p : scene.primitives) assigned.push_back(p.texture);
    std::vector<float> tints;
    for (const Material& m : scene.materials) tints.insert(tints.end(), {m.tint.x, m.tint.y, m.tint.z});
    writer.dataset<std::int32_t>(kShapes, shapes, kColumns);
    writer.dataset<std::int32_t>("/textures/texel", texels);
    writer.dataset<std::int32_t>("/primitives/texture", assigned);
    writer.dataset<float>("/materials/tint", tints, 3);
  }
  if (scene.texcoords.empty()) return;
  std::vector<float> texcoords;
  for (const Texcoords& corners : scene.texcoords)
    for (const Vec2f& t : corners) texcoords.insert(texcoords.end(), {t.x, t.y});
  writer.dataset<float>("/primitives/texcoord", texcoords, 2, 4);
}

void read_texture_datasets(const H5Reader& reader, PatchSet& scene) {
  const auto count = std::int64_t(scene.primitives.size());
  if (reader.has(kShapes)) {
    read_textures(reader, scene.textures);
    const std::vector<std::int32_t> assigned = reader.dataset<std::int32_t>("/primitives/texture", count);
    for (std::size_t i = 0; i < assigned.size(); ++i) scene.primitives[i].texture = assigned[i];
    const std::vector<float> tints = reader.dataset<float>("/materials/tint", std::int64_t(scene.materials.size()), 3);
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
      scene.materials[i].tint = Color(tints[3 * i], tints[3 * i + 1], tints[3 * i + 2]);
  }
  if (!reader.has("/primitives/texcoord")) return;
  const std::vector<float> values = reader.dataset<float>("/primitives/texcoord", count, 2, 4);
  for (std::size_t i = 0; i < values.size(); i += 8)
    scene.texcoords.push_back({Vec2f(values[i], values[i + 1]), Vec2f(values[i + 2], values[i + 3]),
                               Vec2f(values[i + 4], values[i + 5]), Vec2f(values[i + 6], values[i + 7])});
}

}  // namespace patchlight
