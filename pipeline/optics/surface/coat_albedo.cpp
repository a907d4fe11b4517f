#include "pipeline/optics/surface/coat_albedo.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/mirror.h"

namespace patchlight {

namespace {

constexpr int kCosines = 32;      // nodes; evenly spaced in the root of the cosine
constexpr int kRoughnesses = 20;  // nodes from kMirrorRoughness to 1
constexpr int kMeanSteps = 64;    // of the mean over directions
constexpr std::uint32_t kSamples = 1024;

/// Position among `count` nodes over [0,1]: the node before it and the part of the way to the next.
std::pair<int, float> node_at(float x, int count) {
  const float scaled = std::clamp(x, 0.0f, 1.0f) * float(count - 1);
  const int node = std::min(int(scaled), count - 2);
  return {node, scaled - float(node)};
}

}  // namespace

/// Albedos of one index of refraction.
struct CoatAlbedos::Table {
  explicit Table(float index) : ior(index) {
    tbb::parallel_for(0, kRoughnesses, [&](int r) {
      for (int c = 0; c < kCosines; ++c) values[r][c] = computed(c, r);
      for (int k = 0; k < kMeanSteps; ++k) {
        const float cosine = (float(k) + 0.5f) / kMeanSteps;
        const Pair value = along(r, cosine);
        for (int i = 0; i < 2; ++i) means[r][i] += 2 * cosine * value[i] / kMeanSteps;
      }
    });
    for (int k = 0; k < kMeanSteps; ++k) {
      const float cosine = (float(k) + 0.5f) / kMeanSteps;
      mirror_mean += 2 * cosine * fresnel_rise(ior, cosine) / kMeanSteps;
    }
  }

  Pair computed(int c, int r) const {
    const float root = float(c) / (kCosines - 1), cosine = std::max(root * root, 1e-4f);
    const Vec3f in(std::sqrt(1 - cosine * cosine), 0, -cosine), normal(0, 0, 1);
    const SpecularProperties white{Color(1.0f), roughness_at(r)};
    double whole = 0, rise = 0;
    for (std::uint32_t k = 0; k < kSamples; ++k) {
      Vec3f direction = in;
      Color throughput(1.0f);
      if (!reflect(white, normal, {(float(k) + 0.5f) / kSamples, radical_inverse(k)}, direction, throughput)) continue;
      const float half = std::sqrt(std::max(0.0f, 0.5f * (1.0f - (in ^ direction))));  // cosine to the facet
      whole += throughput.x;
      rise += throughput.x * fresnel_rise(ior, half);
    }
    return {float(whole / kSamples), float(rise / kSamples)};
  }

  static float roughness_at(int r) {
    return kMirrorRoughness + (1.0f - kMirrorRoughness) * float(r) / (kRoughnesses - 1);
  }

  Pair along(int r, float cosine) const {
    const auto [c, part] = node_at(std::sqrt(std::max(cosine, 0.0f)), kCosines);
    Pair result;
    for (int i = 0; i < 2; ++i) result[i] = values[r][c][i] * (1 - part) + values[r][c + 1][i] * part;
    return result;
  }

  float ior;
  std::array<std::array<Pair, kCosines>, kRoughnesses> values;
  std::array<Pair, kRoughnesses> means{};
  float mirror_mean = 0;  ///< Of fresnel_rise().
};

CoatAlbedos::CoatAlbedos(const PatchSet& scene) {
  std::set<float> indices;
  for (const Material& material : scene.materials) {
    if (material.coat.exists()) indices.insert(material.coat.ior);
    if (material.clear_coat.exists())
      indices.insert(SpecularProperties{.clear_coat = material.clear_coat}.clear_layer().coat_ior);
  }
  for (const float ior : indices) tables_.push_back(std::make_shared<const Table>(ior));
}

const CoatAlbedos::Table& CoatAlbedos::table(float ior) const {
  return **std::find_if(tables_.begin(), tables_.end(), [&](const auto& table) { return table->ior == ior; });
}

template <class AtNode>
Color CoatAlbedos::albedo(const SpecularProperties& specular, const Pair& mirror, AtNode at_node) {
  Pair pair = mirror;
  if (specular.roughness >= kMirrorRoughness) {
    const auto [r, part] = node_at((specular.roughness - kMirrorRoughness) / (1 - kMirrorRoughness), kRoughnesses);
    const Pair low = at_node(r), high = at_node(r + 1);
    for (int i = 0; i < 2; ++i) pair[i] = low[i] * (1 - part) + high[i] * part;
  }
  return specular.coat * pair[0] + (Color(specular.coat_grazing) - specular.coat) * pair[1];
}

Color CoatAlbedos::of_coat(const SpecularProperties& specular, float cosine) const {
  if (!specular.has_coat()) return Color(0.0f);
  const Table& from = table(specular.coat_ior);
  return albedo(specular, {1.0f, fresnel_rise(from.ior, cosine)}, [&](int r) { return from.along(r, cosine); });
}

Color CoatAlbedos::mean_of_coat(const SpecularProperties& specular) const {
  if (!specular.has_coat()) return Color(0.0f);
  const Table& from = table(specular.coat_ior);
  return albedo(specular, {1.0f, from.mirror_mean}, [&](int r) { return from.means[r]; });
}

Color CoatAlbedos::at(const SpecularProperties& specular, float cosine) const {
  const Color coat = of_coat(specular, cosine);
  if (!specular.clear_coat.exists()) return coat;
  const Color clear = of_coat(specular.clear_layer(), cosine);
  return clear + (Color(1.0f) - clear) * coat;
}

Color CoatAlbedos::mean(const SpecularProperties& specular) const {
  const Color coat = mean_of_coat(specular);
  if (!specular.clear_coat.exists()) return coat;
  const Color clear = mean_of_coat(specular.clear_layer());
  return clear + (Color(1.0f) - clear) * coat;
}

}  // namespace patchlight
