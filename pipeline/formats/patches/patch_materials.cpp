#include "pipeline/formats/patches/patch_materials.h"

#include <algorithm>
#include <cmath>

#include "pipeline/formats/patches/patch_rows.h"

namespace patchlight {

void write_coat_datasets(H5Writer& writer, const PatchSet& scene) {
  using M = const Material&;
  if (!has_coats(scene.materials)) return;
  if (std::ranges::any_of(scene.materials, [](M m) { return m.clear_coat.exists(); }))
    write_rows<float>(writer, "/materials/clear_coat", scene.materials, 2, [](M m, auto* r) {
      r[0] = m.clear_coat.part;
      r[1] = m.clear_coat.roughness;
    });
  write_rows<float>(writer, "/materials/coat", scene.materials, 6, [](M m, auto* r) {
    put3(r, m.coat.normal);
    r[3] = m.coat.grazing;
    r[4] = m.coat.ior;
    r[5] = m.coat.metallic;
  });
  write_rows<float>(writer, "/patches/coat_transmittance", scene.patches, 3,
                    [](const Patch& p, auto* r) { put3(r, p.transmittance); });
}

void read_coat_datasets(const H5Reader& reader, PatchSet& scene) {
  if (!reader.has("/materials/coat")) return;
  read_rows<float>(reader, "/materials/coat", scene.materials, 6, [](Material& m, auto* r) {
    m.coat = {get3<Color>(r), r[3], r[4], r[5]};
  });
  if (reader.has("/materials/clear_coat"))
    read_rows<float>(reader, "/materials/clear_coat", scene.materials, 2, [](Material& m, auto* r) {
      m.clear_coat = {r[0], r[1]};
    });
  read_rows<float>(reader, "/patches/coat_transmittance", scene.patches, 3,
                   [](Patch& p, auto* r) { p.transmittance = get3<Color>(r); });
}

void write_transmissions(H5Writer& writer, const std::vector<Material>& materials) {
  using M = const Material&;
  if (std::ranges::none_of(materials, [](M m) { return m.transmission.exists(); })) return;
  write_rows<float>(writer, "/materials/transmission", materials, 9, [](M m, auto* r) {
    r[0] = m.transmission.part;
    put3(r + 1, m.transmission.tint);
    r[4] = m.transmission.solid ? 1.0f : 0.0f;
    r[5] = m.transmission.ior;
    put3(r + 6, m.transmission.absorption);
  });
}

void read_transmissions(const H5Reader& reader, std::vector<Material>& materials) {
  if (!reader.has("/materials/transmission")) return;
  read_rows<float>(reader, "/materials/transmission", materials, 9, [](Material& m, auto* r) {
    m.transmission = {r[0], get3<Color>(r + 1), r[4] != 0.0f, r[5], get3<Color>(r + 6)};
  });
}

void write_translucences(H5Writer& writer, const std::vector<Material>& materials) {
  using M = const Material&;
  if (std::ranges::none_of(materials, [](M m) { return m.translucence != Color(0.0f); })) return;
  write_rows<float>(writer, "/materials/translucence", materials, 3, [](M m, auto* r) { put3(r, m.translucence); });
}

void read_translucences(const H5Reader& reader, std::vector<Material>& materials) {
  if (!reader.has("/materials/translucence")) return;
  read_rows<float>(reader, "/materials/translucence", materials, 3,
                   [](Material& m, auto* r) { m.translucence = get3<Color>(r); });
}

bool is_valid(const Material& material) {
  const auto in_unit = [](float x) { return x >= 0.0f && x <= 1.0f; };
  const auto each = [](const Color& color, auto test) { return test(color.x) && test(color.y) && test(color.z); };
  const Coat& coat = material.coat;
  const Transmission& glass = material.transmission;
  const bool is_surface_valid = each(material.specular, in_unit) && each(material.tint, in_unit) &&
                                each(material.metal, in_unit) && in_unit(material.roughness) &&
                                in_unit(material.roughness_factor) && std::isfinite(material.normal_scale) &&
                                each(material.emission_tint, [](float x) { return x >= 0.0f && x <= 3e38f; });
  const bool is_coat_valid = each(coat.normal, in_unit) && in_unit(coat.grazing) && in_unit(coat.metallic) &&
                             (coat.ior == 0.0f || (coat.ior >= 1.0f && coat.ior <= 100.0f));
  return is_surface_valid && each(material.translucence, in_unit) && in_unit(material.clear_coat.part) &&
         in_unit(material.clear_coat.roughness) && is_coat_valid && in_unit(glass.part) && each(glass.tint, in_unit) &&
         glass.ior >= 1.0f && glass.ior <= 100.0f &&
         each(glass.absorption, [](float x) { return x >= 0.0f && std::isfinite(x); });
}

}  // namespace patchlight
