#include "importers/gltf/check/texture_check.h"

namespace patchlight {
namespace {

constexpr std::size_t kMaxTexcoordSets = 1000;

}  // namespace

void check_textures(const GltfLists& gltf) {
  gltf.each("textures", [&](const Json& texture, const GltfPlace& place) {
    index_member(texture, "source", gltf.count("images"), place);
    index_member(texture, "sampler", gltf.count("samplers"), place);
    for (const char* name : {kWebp, kBasisu})
      if (const Json* extension = find_extension(texture, name, place))
        index_member(*extension, "source", gltf.count("images"), place);
  });
  gltf.each("samplers", [&](const Json& sampler, const GltfPlace& place) {
    for (const char* key : {"magFilter", "wrapS", "wrapT"}) whole_number(sampler, key, 0, place);
  });
}

void check_texture_info(const GltfLists& gltf, const Json& owner, const char* key, const GltfPlace& place) {
  const Json* info = find_object(owner, key, place);
  if (!info) return;
  if (index_member(*info, "index", gltf.count("textures"), place) < 0) refuse_gltf("has no index", place, key);
  index_member(*info, "texCoord", kMaxTexcoordSets, place);
  if (const Json* transform = find_extension(*info, "KHR_texture_transform", place)) {
    check_numbers(*transform, "offset", 2, place);
    check_numbers(*transform, "scale", 2, place);
    check_number(*transform, "rotation", place);
    index_member(*transform, "texCoord", kMaxTexcoordSets, place);
  }
}

int texture_image(const Json& texture) {
  const Json* extensions = find_member(texture, "extensions");
  const Json* webp = extensions ? find_member(*extensions, kWebp) : nullptr;
  const Json* source = find_member(webp && webp->contains("source") ? *webp : texture, "source");
  return source ? source->get<int>() : -1;
}

}  // namespace patchlight
