#include "importers/patches/patch_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/model/error.h"
#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/coat_albedo.h"
#include "pipeline/optics/surface/material_shader.h"
#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {
namespace {

constexpr double kRounding = 1e-6;  // shader values down to -kRounding count as 0
constexpr double kUniformSpread =
    1.0 / 32;  // spread of samples, relative to max(1, largest), below which kCoarse suffice

/// A Fibonacci lattice in the unit square. The points' projections on each axis are evenly spaced, so that stripes
/// along an edge are sampled at `count` different coordinates.
struct Lattice {
  int count;
  int step;

  Vec2f point(int i) const {
    const auto centered = [this](int k) { return (static_cast<float>(k) + 0.5f) / static_cast<float>(count); };
    return {centered(i), centered(i * step % count)};
  }
};
constexpr Lattice kCoarse{21, 13};
constexpr Lattice kFine{377, 233};
constexpr Lattice kFinest{987, 610};
constexpr float kMinCoverage = 1.0f / 1024;

/// Evaluates one colour of one shader on one primitive.
struct ColorSource {
  const Job& job;
  const Shader& shader;
  const char* key;
  Color limit{1.0f};     ///< Greatest value per channel.
  bool lowered = false;  ///< A value exceeded the limit.

  /// The value clamped to [0, limit]. Throws: Error (bad_config) for a negative or non-finite value.
  Vec3d checked(const Vec3d& value, const ExpressionInputs& at) {
    Vec3d result;
    for (int k = 0; k < 3; ++k) {
      if (!(value[k] >= -kRounding && value[k] <= kMaxEmission)) {
        throw Error(
            ExitCode::bad_config,
            fmt::format("{} is {:g} in {} at u {:.6g}, v {:.6g}, x {:.6g}, y {:.6g}, z {:.6g}", key, value[k],
                        std::array{"red", "green", "blue"}[k], at.u, at.v, at.position.x, at.position.y, at.position.z),
            fmt::format("{}, shaders.{}.{}", job.file.string(), shader.name, key),
            "it must be finite and not negative");
      }
      lowered = lowered || value[k] > static_cast<double>(limit[k]) + kRounding;
      result[k] = std::clamp<double>(value[k], 0.0, limit[k]);
    }
    return result;
  }
};

bool is_uniform(const Vec3d& low, const Vec3d& high) {
  for (int k = 0; k < 3; ++k) {
    if (high[k] - low[k] > kUniformSpread * std::max(1.0, high[k])) return false;
  }
  return true;
}

/// Means over the part of a patch that passes the alpha test.
class PatchMean {
 public:
  PatchMean(const PatchSet& scene, const Patch& patch) : sampler_(scene.primitives, patch) {
    if (scene.primitives[patch.primitive].mask < 0) return;
    for (const Lattice& lattice : {kFine, kFinest}) {
      opaque_points_.clear();
      for (int i = 0; i < lattice.count; ++i) {
        const PatchSampler::Place at = place(lattice, i);
        const float chance = uniform01(hash64(static_cast<std::uint64_t>(i)));
        if (passes_alpha_test(scene, at.primitive, at.uv.x, at.uv.y, chance)) opaque_points_.push_back(at);
      }
      coverage_ = static_cast<float>(opaque_points_.size()) / static_cast<float>(lattice.count);
      if (opaque_points_.empty() || coverage_ == 1.0f) break;
    }
    coverage_ = std::max(coverage_, kMinCoverage);
  }

  /// Fraction of the patch that passes the alpha test.
  float coverage() const { return coverage_; }

  /// Mean of `value(primitive, u, v)`.
  template <class Value>
  Color operator()(const Value& value) const {
    if (!opaque_points_.empty() && coverage_ < 1.0f) {
      Vec3d sum(0.0);
      for (const auto& [i, at] : opaque_points_) sum += value(i, at.x, at.y);
      return Color(sum / static_cast<double>(opaque_points_.size()));
    }
    for (const Lattice& lattice : {kCoarse, kFine}) {
      Vec3d sum(0.0);
      Vec3d low(0.0);
      Vec3d high(0.0);
      for (int i = 0; i < lattice.count; ++i) {
        const auto [primitive, at] = place(lattice, i);
        const Vec3d sample = value(primitive, at.x, at.y);
        sum += sample;
        for (int k = 0; k < 3; ++k) {
          low[k] = i == 0 ? sample[k] : std::min(low[k], sample[k]);
          high[k] = std::max(high[k], sample[k]);
        }
      }
      if (lattice.count == kFine.count || is_uniform(low, high)) return Color(sum / lattice.count);
    }
    return Color(0.0f);
  }

 private:
  PatchSampler::Place place(const Lattice& lattice, int i) const {
    const Vec2f at = lattice.point(i);
    return sampler_.place(at.x, at.y);
  }

  const PatchSampler sampler_;
  float coverage_ = 1.0f;
  std::vector<PatchSampler::Place> opaque_points_{};  ///< Samples that pass the alpha test; empty without a mask.
};

bool has_colored_primitive(const PatchSet& scene, const Patch& patch) {
  for (std::int32_t i = patch.primitive; i < patch.primitive + std::max(1, patch.facets); ++i)
    if (is_colored(scene, i)) return true;
  return false;
}

}  // namespace

void average_colors(const Job& job, PatchSet& scene, Progress& progress) {
  std::vector<MaterialShader> shaders = compile_shaders(scene);
  std::vector<char> lowered(shaders.size(), 0);
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    Patch& patch = scene.patches[i];
    const Primitive& primitive = scene.primitives[patch.primitive];
    const bool colored = has_colored_primitive(scene, patch);
    if (!colored && primitive.emission_texture < 0 && primitive.mask < 0 && primitive.shader < 0) continue;
    const PatchMean mean(scene, patch);
    patch.coverage = mean.coverage();
    if (colored) {
      patch.reflectance = mean([&](std::int32_t p, double u, double v) {
        const Color color = colored_reflectance(scene, p, u, v);
        return Vec3d(color.x, color.y, color.z);
      });
    }
    if (primitive.emission_texture >= 0) {
      patch.emission = mean([&](std::int32_t p, double u, double v) {
        const Color color = textured_emission(scene, p, u, v);
        return Vec3d(color.x, color.y, color.z);
      });
    }
    if (primitive.shader < 0) continue;
    const Shader& source = scene.shaders[primitive.shader];
    MaterialShader& shader = shaders[primitive.shader];
    if (shader.reflects()) {
      ColorSource color{job, source, "reflectance", max_diffuse_reflectance(scene.materials[primitive.material])};
      patch.reflectance = clamp_color(Vec3d(mean([&](std::int32_t p, double u, double v) {
                                        const auto at = shader_inputs(scene, p, u, v);
                                        return color.checked(shader.reflectance(at), at);
                                      })),
                                      color.limit);
      lowered[primitive.shader] |= color.lowered;
    }
    if (shader.emits()) {
      ColorSource color{job, source, "emission", Color(kMaxEmission)};
      patch.emission = mean([&](std::int32_t p, double u, double v) {
        const auto at = shader_inputs(scene, p, u, v);
        return color.checked(shader.emission(at), at);
      });
    }
    progress.update(static_cast<double>(i) / static_cast<double>(scene.patches.size()), "colours");
  }
  for (std::size_t i = 0; i < shaders.size(); ++i) {
    if (lowered[i] == 0) continue;
    progress.warning(
        fmt::format("reflectance of shader '{}' is lowered to 0.99999, or to 1 minus the specular reflectance, where "
                    "it is greater: the surface would reflect more light than it receives",
                    scene.shaders[i].name));
  }
}

void average_coats(PatchSet& scene) {
  const CoatAlbedos coats(scene);
  if (!coats.any()) return;
  for (Patch& patch : scene.patches) {
    if (!scene.materials[scene.primitives[patch.primitive].material].is_coated()) continue;
    const auto passed = [&](std::int32_t p, double u, double v) {
      return Vec3d(Color(1.0f) - coats.mean(specular_properties_at(scene, p, u, v)));
    };
    patch.transmittance = has_varying_coat(scene, patch.primitive) ? PatchMean(scene, patch)(passed)
                                                                   : Color(passed(patch.primitive, 0.5, 0.5));
  }
}

}  // namespace patchlight
