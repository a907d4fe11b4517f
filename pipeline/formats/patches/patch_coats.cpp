#include "pipeline/formats/patches/patch_coats.h"

#include "pipeline/formats/patches/patch_rows.h"

namespace patchlight {

void write_coat_datasets(H5Writer& writer, const PatchSet& scene) {
  using M = const Material&;
  if (!has_coats(scene.materials)) return;
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
  read_rows<float>(reader, "/patches/coat_transmittance", scene.patches, 3,
                   [](Patch& p, auto* r) { p.transmittance = get3<Color>(r); });
}

bool is_valid(const Coat& coat) {
  const auto in_unit = [](float x) { return x >= 0.0f && x <= 1.0f; };
  return in_unit(coat.normal.x) && in_unit(coat.normal.y) && in_unit(coat.normal.z) && in_unit(coat.grazing) &&
         in_unit(coat.metallic) && (coat.ior == 0.0f || (coat.ior >= 1.0f && coat.ior <= 100.0f));
}

}  // namespace patchlight
