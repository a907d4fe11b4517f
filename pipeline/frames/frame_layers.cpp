#include "pipeline/frames/frame_layers.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

constexpr std::size_t kMaxGroupNameBytes = 240;  // a channel name has at most 255 bytes

constexpr std::array<std::string_view, 7> kLightPathLayers{"direct", "indirect",     "specular", "metal",
                                                           "coat",   "transmission", "emission"};

}  // namespace

std::vector<ImageLayer> frame_layers(const TraceConfig& config, const PatchSet& scene) {
  std::vector<ImageLayer> layers;
  const std::vector<Color> colors;
  for (const std::string& name : config.layers) {
    if (name == "depth")
      layers.push_back({name, "Z", std::vector<float>()});
    else if (name == "patch")
      layers.push_back({name, "X", std::vector<std::uint32_t>()});
    else if (name == "normal" || name == "position")
      layers.push_back({name, "XYZ", colors});
    else if (name == "light_groups")
      for (const std::string& group : scene.light_groups) {
        if (group.size() > kMaxGroupNameBytes)
          throw Error(ExitCode::bad_config,
                      "the light group `" + group.substr(0, 40) + "...` has a name too long for an EXR", "trace.layers",
                      "leave out `light_groups`, or rename the group in the scene");
        layers.push_back({kLightGroupLayer + group, "RGB", colors});
      }
    else
      layers.push_back({name, "RGB", colors});
  }
  return layers;
}

std::vector<ImageLayer> relit_layers(const TraceConfig& config, const PatchSet& scene) {
  std::vector<ImageLayer> layers = frame_layers(config, scene);
  std::erase_if(layers, [](const ImageLayer& layer) { return is_light_path_layer(layer.name); });
  return layers;
}

bool is_light_path_layer(const std::string& layer) {
  return std::find(kLightPathLayers.begin(), kLightPathLayers.end(), layer) != kLightPathLayers.end();
}

bool have_same_format(const ImageLayer& a, const ImageLayer& b) {
  return a.name == b.name && a.channels == b.channels && a.values.index() == b.values.index();
}

std::string missing_layer(const Image& image, const std::vector<ImageLayer>& wanted) {
  for (const ImageLayer& layer : wanted)
    if (std::none_of(image.layers.begin(), image.layers.end(),
                     [&](const auto& present) { return have_same_format(present, layer); }))
      return layer.name;
  return "";
}

}  // namespace patchlight
