#include "importers/gltf/check/camera_check.h"

#include <fmt/format.h>

#include "pipeline/model/camera.h"

namespace patchlight {
namespace {

double number_within(const Json& value, double low, double high, const GltfPlace& place, const std::string& member) {
  const double number = value.is_number() ? value.get<double>() : 0.0;
  if (!value.is_number() || !(number >= low && number <= high))
    refuse_gltf(fmt::format("must be a number from {} to {}", low, high), place, member);
  return number;
}

}  // namespace

std::map<int, GltfLens> checked_lenses(GltfLists& gltf) {
  std::map<int, GltfLens> lenses;
  gltf.each("nodes", [&](const Json& node, const GltfPlace& place) {
    const Json* extras = find_member(node, "extras");
    if (!node.contains("camera") || !extras || !extras->is_object()) return;
    GltfLens lens;
    if (const Json* shift = find_member(*extras, "shift")) {
      if (!shift->is_array() || shift->size() != 2) refuse_gltf("must be two numbers [x, y]", place, "extras.shift");
      lens.shift.emplace();
      for (int k = 0; k < 2; ++k)
        (*lens.shift)[k] = number_within((*shift)[std::size_t(k)], -kMaxShift, kMaxShift, place, "extras.shift");
    }
    const auto read = [&](const char* key, double low, double high, std::optional<double>& value) {
      if (const Json* member = find_member(*extras, key))
        value = number_within(*member, low, high, place, std::string("extras.") + key);
    };
    read("aspect", kMinAspect, kMaxAspect, lens.aspect);
    read("aperture", 0, kMaxAperture, lens.aperture);
    read("focus", kMinDepth, kMaxDepth, lens.focus);
    if (lens.aperture.value_or(0) > 0 && !lens.focus)
      refuse_gltf("needs `focus`, the depth that is sharp", place, "extras.aperture");
    lenses.emplace(int(place.index), lens);
  });
  return lenses;
}

}  // namespace patchlight
