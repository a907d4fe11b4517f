#include "pipeline/formats/patches/patch_textures.h"

#include <algorithm>

#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace {

constexpr int kColumns = 5;  // width, height, wraps, nearest

Texture::Wrap wrap_of(const H5Reader& reader, std::int32_t value, const std::string& name) {
  if (value < 0 || value > 2) reader.refuse("an unknown wrap", name);
  return Texture::Wrap(value);
}

/// `group` is /textures or /masks.
void write_images(H5Writer& writer, const std::string& group, const std::vector<Texture>& textures) {
  std::vector<std::int32_t> shapes, texels;
  for (const Texture& t : textures) {
    shapes.insert(shapes.end(), {t.width, t.height, std::int32_t(t.wrap[0]), std::int32_t(t.wrap[1]), t.nearest});
    texels.insert(texels.end(), t.texels.begin(), t.texels.end());
  }
  writer.dataset<std::int32_t>(group + "/shape", shapes, kColumns);
  writer.dataset<std::int32_t>(group + "/texel", texels);
}

void read_images(const H5Reader& reader, const std::string& group, std::vector<Texture>& textures) {
  const std::string name = group + "/shape";
  const std::vector<std::int32_t> shapes = reader.dataset<std::int32_t>(name, -1, kColumns);
  const std::vector<std::int32_t> texels = reader.dataset<std::int32_t>(group + "/texel", -1);
  std::size_t next = 0;
  for (std::size_t k = 0; k < shapes.size(); k += kColumns) {
    const std::int64_t width = shapes[k], height = shapes[k + 1];
    if (width < 1 || height < 1 || width * height > std::int64_t(texels.size() - next))
      reader.refuse("a size that does not match the number of texels", name);
    const auto first = texels.begin() + std::ptrdiff_t(next);
    textures.push_back({shapes[k],
                        shapes[k + 1],
                        {wrap_of(reader, shapes[k + 2], name), wrap_of(reader, shapes[k + 3], name)},
                        shapes[k + 4] != 0,
                        {first, first + width * height}});
    next += std::size_t(width * height);
  }
}

void write_indices(H5Writer& writer, const std::string& name, const PatchSet& scene, std::int32_t Primitive::*index) {
  std::vector<std::int32_t> values;
  for (const Primitive& p : scene.primitives) values.push_back(p.*index);
  writer.dataset<std::int32_t>(name, values);
}

void read_indices(const H5Reader& reader, const std::string& name, PatchSet& scene, std::int32_t Primitive::*index) {
  const std::vector<std::int32_t> values = reader.dataset<std::int32_t>(name, std::int64_t(scene.primitives.size()));
  for (std::size_t i = 0; i < values.size(); ++i) scene.primitives[i].*index = values[i];
}

void write_tints(H5Writer& writer, const std::string& name, const PatchSet& scene, Color Material::*tint) {
  std::vector<float> values;
  for (const Material& m : scene.materials) values.insert(values.end(), {(m.*tint).x, (m.*tint).y, (m.*tint).z});
  writer.dataset<float>(name, values, 3);
}

void read_tints(const H5Reader& reader, const std::string& name, PatchSet& scene, Color Material::*tint) {
  const std::vector<float> values = reader.dataset<float>(name, std::int64_t(scene.materials.size()), 3);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    scene.materials[i].*tint = Color(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
}

void write_texcoords(H5Writer& writer, const std::string& name, const std::vector<Texcoords>& all) {
  if (all.empty()) return;
  std::vector<float> texcoords;
  for (const Texcoords& corners : all)
    for (const Vec2f& t : corners) texcoords.insert(texcoords.end(), {t.x, t.y});
  writer.dataset<float>(name, texcoords, 2, 4);
}

void read_texcoords(const H5Reader& reader, const std::string& name, std::size_t primitives,
                    std::vector<Texcoords>& all) {
  if (!reader.has(name)) return;
  all.resize(primitives);
  const auto fill = [](Texcoords& corners, const float* row) {
    for (std::size_t k = 0; k < 4; ++k) corners[k] = Vec2f(row[2 * k], row[2 * k + 1]);
  };
  reader.read_into<float>(name, all, 2, fill, 4);
}

/// Whether any primitive has an index in this member.
bool any_has(const PatchSet& scene, std::int32_t Primitive::*index) {
  return std::any_of(scene.primitives.begin(), scene.primitives.end(),
                     [&](const Primitive& p) { return p.*index >= 0; });
}

bool has_varying_metals(const PatchSet& scene) {
  for (std::size_t i = 0; i < scene.primitives.size(); ++i)
    if (has_varying_metal(scene, std::int32_t(i)) || has_varying_coat(scene, std::int32_t(i))) return true;
  return false;
}

/// Whether colours may vary what glass lets pass.
bool has_colored_glass(const PatchSet& scene) {
  const auto is_glass = [](const Material& material) { return material.transmission.exists(); };
  if (std::ranges::none_of(scene.materials, is_glass)) return false;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i)
    if (is_colored(scene, std::int32_t(i))) return true;
  return false;
}

void write_metallic_roughness(H5Writer& writer, const PatchSet& scene) {
  write_tints(writer, "/materials/metal", scene, &Material::metal);
  if (!any_has(scene, &Primitive::metallic_roughness_texture)) return;
  write_indices(writer, "/primitives/finish_texture", scene, &Primitive::metallic_roughness_texture);
  std::vector<float> values;
  for (const Material& m : scene.materials) values.push_back(m.roughness_factor);
  writer.dataset<float>("/materials/finish_roughness", values);
}

void read_metallic_roughness(const H5Reader& reader, PatchSet& scene) {
  read_tints(reader, "/materials/metal", scene, &Material::metal);
  if (!reader.has("/primitives/finish_texture")) return;
  read_indices(reader, "/primitives/finish_texture", scene, &Primitive::metallic_roughness_texture);
  const auto values = reader.dataset<float>("/materials/finish_roughness", std::int64_t(scene.materials.size()));
  for (std::size_t i = 0; i < values.size(); ++i) scene.materials[i].roughness_factor = values[i];
}

void write_masks(H5Writer& writer, const PatchSet& scene) {
  write_images(writer, "/masks", scene.masks);
  write_indices(writer, "/primitives/mask", scene, &Primitive::mask);
  std::vector<float> alphas, coverages;
  for (const Material& m : scene.materials) alphas.insert(alphas.end(), {m.alpha, m.alpha_cutoff});
  for (const Patch& patch : scene.patches) coverages.push_back(patch.coverage);
  writer.dataset<float>("/materials/alpha", alphas, 2);
  writer.dataset<float>("/patches/coverage", coverages);
}

void read_masks(const H5Reader& reader, PatchSet& scene) {
  read_images(reader, "/masks", scene.masks);
  read_indices(reader, "/primitives/mask", scene, &Primitive::mask);
  const auto alphas = reader.dataset<float>("/materials/alpha", std::int64_t(scene.materials.size()), 2);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    scene.materials[i].alpha = alphas[2 * i];
    scene.materials[i].alpha_cutoff = alphas[2 * i + 1];
  }
  const auto coverages = reader.dataset<float>("/patches/coverage", std::int64_t(scene.patches.size()));
  for (std::size_t i = 0; i < scene.patches.size(); ++i) scene.patches[i].coverage = coverages[i];
}

void write_colors(H5Writer& writer, const PatchSet& scene) {
  std::vector<float> colors, alphas;
  for (const CornerColors& corners : scene.colors)
    for (const Vec4f& c : corners) {
      colors.insert(colors.end(), {c.x, c.y, c.z});
      alphas.push_back(c.w);
    }
  writer.dataset<float>("/primitives/color", colors, 3, 4);
  writer.dataset<float>("/primitives/alpha", alphas, 4);
}

void read_colors(const H5Reader& reader, PatchSet& scene) {
  scene.colors.resize(scene.primitives.size());
  const auto set_color = [](CornerColors& corners, const float* row) {
    for (std::size_t k = 0; k < 4; ++k) corners[k] = Vec4f(row[3 * k], row[3 * k + 1], row[3 * k + 2], 1.0f);
  };
  reader.read_into<float>("/primitives/color", scene.colors, 3, set_color, 4);
  reader.read_into<float>("/primitives/alpha", scene.colors, 4, [](CornerColors& corners, const float* row) {
    for (std::size_t k = 0; k < 4; ++k) corners[k].w = row[k];
  });
}

void write_normals(H5Writer& writer, const PatchSet& scene) {
  std::vector<float> normals;
  for (const CornerNormals& corners : scene.normals)
    for (const Vec3f& n : corners) normals.insert(normals.end(), {n.x, n.y, n.z});
  writer.dataset<float>("/primitives/normals", normals, 3, 4);
}

void read_normals(const H5Reader& reader, PatchSet& scene) {
  scene.normals.resize(scene.primitives.size());
  const auto fill = [&](CornerNormals& corners, const float* row) {
    for (std::size_t k = 0; k < 4; ++k) corners[k] = Vec3f(row[3 * k], row[3 * k + 1], row[3 * k + 2]);
    if (corners == kFlatNormals) return;
    for (const Vec3f& n : corners)
      if (!(std::abs(n.length() - 1.0f) <= 1e-3f))
        reader.refuse("a vector that is not of unit length", "/primitives/normals");
  };
  reader.read_into<float>("/primitives/normals", scene.normals, 3, fill, 4);
}

}  // namespace

void write_texture_datasets(H5Writer& writer, const PatchSet& scene) {
  if (!scene.textures.empty()) {
    write_images(writer, "/textures", scene.textures);
    write_indices(writer, "/primitives/texture", scene, &Primitive::texture);
  }
  if (!scene.textures.empty() || !scene.colors.empty()) write_tints(writer, "/materials/tint", scene, &Material::tint);
  if (has_varying_metals(scene)) write_metallic_roughness(writer, scene);
  if (any_has(scene, &Primitive::normal_texture)) {
    write_indices(writer, "/primitives/normal_texture", scene, &Primitive::normal_texture);
    std::vector<float> scales;
    for (const Material& m : scene.materials) scales.push_back(m.normal_scale);
    writer.dataset<float>("/materials/normal_scale", scales);
  }
  if (any_has(scene, &Primitive::emission_texture)) {
    write_indices(writer, "/primitives/emission_texture", scene, &Primitive::emission_texture);
    write_tints(writer, "/materials/emission_tint", scene, &Material::emission_tint);
  }
  if (!scene.masks.empty()) write_masks(writer, scene);
  if (!scene.colors.empty()) write_colors(writer, scene);
  if (!scene.normals.empty()) write_normals(writer, scene);
  write_texcoords(writer, "/primitives/texcoord", scene.texcoords);
  write_texcoords(writer, "/primitives/emission_texcoord", scene.emission_texcoords);
  write_texcoords(writer, "/primitives/finish_texcoord", scene.metallic_roughness_texcoords);
  write_texcoords(writer, "/primitives/normal_texcoord", scene.normal_texcoords);
}

std::vector<std::string> transport_textures(const PatchSet& scene) {
  std::vector<std::string> names;
  if (!scene.masks.empty()) names = {"/masks/", "/primitives/mask", "/primitives/alpha", "/primitives/texcoord"};
  if (has_varying_metals(scene) || has_colored_glass(scene))
    names.insert(names.end(), {"/textures/", "/primitives/texture", "/primitives/texcoord", "/primitives/color",
                               "/primitives/finish"});
  return names;
}

std::string metallic_roughness_key(const PatchSet& scene) {
  KeyHasher hasher;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const auto material = std::size_t(scene.primitives[i].material);
    if (material >= scene.materials.size()) continue;  // an invalid scene, which read_patches refuses
    const Material& m = scene.materials[material];
    if (!is_specular(m) && m.metal == Color(0.0f) && scene.primitives[i].mask < 0 && !m.transmission.exists()) continue;
    hasher.add(std::int64_t(i));
    for (const Color& color : {m.specular, m.metal})
      for (int k = 0; k < 3; ++k) hasher.add(double(color[k]));
    for (const float value : {m.roughness, m.roughness_factor, m.alpha, m.alpha_cutoff}) hasher.add(double(value));
    if (const Transmission& glass = m.transmission; glass.exists()) {
      for (const float value : {glass.part, glass.ior, glass.solid ? 1.0f : 0.0f}) hasher.add(double(value));
      for (const Color& color : {glass.tint, glass.absorption})
        for (int k = 0; k < 3; ++k) hasher.add(double(color[k]));
    }
    if (m.clear_coat.exists())
      hasher.add("clear coat").add(double(m.clear_coat.part)).add(double(m.clear_coat.roughness));
    if (!m.coat.exists()) continue;
    for (int k = 0; k < 3; ++k) hasher.add(double(m.coat.normal[k]));
    for (const float value : {m.coat.grazing, m.coat.ior, m.coat.metallic}) hasher.add(double(value));
  }
  return hasher.hex();
}

void read_texture_datasets(const H5Reader& reader, PatchSet& scene) {
  if (reader.has("/textures/shape")) {
    read_images(reader, "/textures", scene.textures);
    read_indices(reader, "/primitives/texture", scene, &Primitive::texture);
  }
  if (reader.has("/materials/tint")) read_tints(reader, "/materials/tint", scene, &Material::tint);
  if (reader.has("/materials/metal")) read_metallic_roughness(reader, scene);
  if (reader.has("/primitives/emission_texture")) {
    read_indices(reader, "/primitives/emission_texture", scene, &Primitive::emission_texture);
    read_tints(reader, "/materials/emission_tint", scene, &Material::emission_tint);
  }
  if (reader.has("/primitives/normal_texture")) {
    read_indices(reader, "/primitives/normal_texture", scene, &Primitive::normal_texture);
    const auto scales = reader.dataset<float>("/materials/normal_scale", std::int64_t(scene.materials.size()));
    for (std::size_t i = 0; i < scales.size(); ++i) scene.materials[i].normal_scale = scales[i];
  }
  if (reader.has("/masks/shape")) read_masks(reader, scene);
  if (reader.has("/primitives/color")) read_colors(reader, scene);
  if (reader.has("/primitives/normals")) read_normals(reader, scene);
  const std::size_t count = scene.primitives.size();
  read_texcoords(reader, "/primitives/texcoord", count, scene.texcoords);
  read_texcoords(reader, "/primitives/emission_texcoord", count, scene.emission_texcoords);
  read_texcoords(reader, "/primitives/finish_texcoord", count, scene.metallic_roughness_texcoords);
  read_texcoords(reader, "/primitives/normal_texcoord", count, scene.normal_texcoords);
}

}  // namespace patchlight
