#include "tracer/output/layer_sums.h"

#include <algorithm>

#include "pipeline/frames/frame_layers.h"

namespace patchlight {

namespace {

bool asks_for_any(const TraceConfig& config, std::initializer_list<std::string_view> names) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view name) { return config.asks_for(name); });
}

}  // namespace

LayerSums::LayerSums(const TraceConfig& config, const PatchSet& scene, std::size_t pixels) : config_(config) {
  if (asks_for_any(config, {"direct", "indirect", "specular", "metal", "coat", "transmission", "emission"}))
    for (auto* sums : {&emission_, &direct_, &indirect_, &metal_, &coat_, &glass_}) sums->assign(pixels, Color(0.0f));
  if (asks_for_any(config, {"albedo", "normal", "depth", "position", "patch"})) {
    for (auto* sums : {&albedo_, &normal_}) sums->assign(pixels, Color(0.0f));
    nearest_.resize(pixels);
  }
  if (config.asks_for("light_groups"))
    by_group_.assign(scene.light_groups.size(), std::vector<Color>(pixels, Color(0.0f)));
}

void LayerSums::add_surface(std::uint32_t pixel, const Surface& surface, float distance2) {
  albedo_[pixel] += surface.albedo;
  normal_[pixel] += surface.normal;
  if (distance2 < nearest_[pixel].distance2)
    nearest_[pixel] = {distance2, surface.depth, Vec3f(surface.position), surface.patch};
}

void LayerSums::set_surface(std::uint32_t pixel, const Surface& surface) {
  nearest_[pixel] = {nearest_[pixel].distance2, surface.depth, Vec3f(surface.position), surface.patch};
}

std::vector<ImageLayer> LayerSums::blank(const TraceConfig& config, const PatchSet& scene, std::size_t pixels) {
  std::vector<ImageLayer> layers = frame_layers(config, scene);
  for (ImageLayer& layer : layers)
    std::visit([&]<class Value>(std::vector<Value>& values) { values.assign(pixels, Value(0)); }, layer.values);
  return layers;
}

void LayerSums::resolve(std::uint32_t pixel, int samples, std::size_t at, std::vector<ImageLayer>& layers) const {
  auto layer = layers.begin();
  const auto resolve_color = [&](const Color& sum) {
    std::get<std::vector<Color>>((layer++)->values)[at] = sum / float(samples);
  };
  const auto resolve_mean = [&](const std::vector<Color>& sums) { resolve_color(sums[pixel]); };
  for (const std::string& name : config_.layers) {
    if (name == "direct") resolve_mean(direct_);
    if (name == "indirect") resolve_mean(indirect_);
    if (name == "specular") resolve_color(metal_[pixel] + coat_[pixel] + glass_[pixel]);
    if (name == "metal") resolve_mean(metal_);
    if (name == "coat") resolve_mean(coat_);
    if (name == "transmission") resolve_mean(glass_);
    if (name == "emission") resolve_mean(emission_);
    if (name == "albedo") resolve_mean(albedo_);
    if (name == "normal") resolve_mean(normal_);
    if (name == "position") std::get<std::vector<Color>>((layer++)->values)[at] = nearest_[pixel].position;
    if (name == "depth") std::get<std::vector<float>>((layer++)->values)[at] = nearest_[pixel].depth;
    if (name == "patch") std::get<std::vector<std::uint32_t>>((layer++)->values)[at] = nearest_[pixel].patch;
    if (name == "light_groups")
      for (const auto& sums : by_group_) resolve_mean(sums);
  }
}

}  // namespace patchlight
