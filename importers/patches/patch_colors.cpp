#include "importers/patches/patch_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/model/error.h"
#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/material_shader.h"
#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {
namespace {

constexpr double kRounding = 1e-6;  // what is less below 0 is 0
constexpr double kEven = 1.0 / 32;  // spread of a patch's samples below which few of them do: of 1, or of their largest

/// Points of the unit square whose projections on both axes are evenly spaced: a Fibonacci lattice. So a stripe along
/// an edge meets as many different columns as there are points.
struct Lattice {
  int count;
  int step;

  Vec2f point(int i) const {
    const auto centered = [this](int k) { return (static_cast<float>(k) + 0.5f) / static_cast<float>(count); };
    return {centered(i), centered(i * step % count)};
  }
};
constexpr Lattice kFew{21, 13};
constexpr Lattice kMany{377, 233};
constexpr Lattice kMost{987, 610};
constexpr float kLeastCoverage = 1.0f / 1024;

/// One colour of one shader on one primitive.
struct ColorSource {
  const Job& job;
  const Shader& shader;
  const char* key;
  Color most{1.0f};
  bool lowered = false;

  /// The value in range. Throws where the job has to be mended.
  Vec3d checked(const Vec3d& value, const ExpressionInputs& at) {
    Vec3d result;
    for (int k = 0; k < 3; ++k) {
      if (!(value[k] >= -kRounding && value[k] <= kMostEmission)) {
        throw Error(
            ExitCode::bad_config,
            fmt::format("{} is {:g} in {} at u {:.6g}, v {:.6g}, x {:.6g}, y {:.6g}, z {:.6g}", key, value[k],
                        std::array{"red", "green", "blue"}[k], at.u, at.v, at.position.x, at.position.y, at.position.z),
            fmt::format("{}, shaders.{}.{}", job.file.string(), shader.name, key),
            "it must be finite and not negative");
      }
      lowered = lowered || value[k] > static_cast<double>(most[k]) + kRounding;
      result[k] = std::clamp<double>(value[k], 0.0, most[k]);
    }
    return result;
  }
};

bool is_even(const Vec3d& low, const Vec3d& high) {
  for (int k = 0; k < 3; ++k) {
    if (high[k] - low[k] > kEven * std::max(1.0, high[k])) return false;
  }
  return true;
}

/// Means over that part of a patch's area which is there.
class PatchMean {
 public:
  PatchMean(const PatchSet& scene, const Patch& patch) : sampler_(scene.primitives[patch.primitive], patch) {
    if (scene.primitives[patch.primitive].mask < 0) return;
    for (const Lattice& lattice : {kMany, kMost}) {
      opaque_points_.clear();
      for (int i = 0; i < lattice.count; ++i) {
        const Imath::V2d at = place(lattice, i);
        if (passes_alpha_test(scene, patch.primitive, at.x, at.y)) opaque_points_.push_back(at);
      }
      coverage_ = static_cast<float>(opaque_points_.size()) / static_cast<float>(lattice.count);
      if (opaque_points_.empty() || coverage_ == 1.0f) break;
    }
    coverage_ = std::max(coverage_, kLeastCoverage);
  }

  float coverage() const { return coverage_; }

  /// Of `value(u, v)`.
  template <class Value>
  Color operator()(const Value& value) const {
    if (!opaque_points_.empty() && coverage_ < 1.0f) {
      Vec3d sum(0.0);
      for (const Imath::V2d& at : opaque_points_) sum += value(at.x, at.y);
      return Color(sum / static_cast<double>(opaque_points_.size()));
    }
    for (const Lattice& lattice : {kFew, kMany}) {
      Vec3d sum(0.0);
      Vec3d low(0.0);
      Vec3d high(0.0);
      for (int i = 0; i < lattice.count; ++i) {
        const Imath::V2d at = place(lattice, i);
        const Vec3d sample = value(at.x, at.y);
        sum += sample;
        for (int k = 0; k < 3; ++k) {
          low[k] = i == 0 ? sample[k] : std::min(low[k], sample[k]);
          high[k] = std::max(high[k], sample[k]);
        }
      }
      if (lattice.count == kMany.count || is_even(low, high)) return Color(sum / lattice.count);
    }
    return Color(0.0f);
  }

 private:
  Imath::V2d place(const Lattice& lattice, int i) const {
    const Vec2f at = lattice.point(i);
    return sampler_.uv(at.x, at.y);
  }

  const PatchSampler sampler_;
  float coverage_ = 1.0f;
  std::vector<Imath::V2d> opaque_points_{};  ///< (u,v) of points of the patch; none where it is not masked.
};

}  // namespace

void average_colors(const Job& job, PatchSet& scene, Progress& progress) {
  std::vector<MaterialShader> shaders = compile_shaders(scene);
  std::vector<char> lowered(shaders.size(), 0);
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    Patch& patch = scene.patches[i];
    const Primitive& primitive = scene.primitives[patch.primitive];
    const bool colored = is_colored(scene, patch.primitive);
    if (!colored && primitive.emission_texture < 0 && primitive.mask < 0 && primitive.shader < 0) continue;
    const PatchMean mean(scene, patch);
    patch.coverage = mean.coverage();
    if (colored) {
      patch.reflectance = mean([&](double u, double v) {
        const Color color = colored_reflectance(scene, patch.primitive, u, v);
        return Vec3d(color.x, color.y, color.z);
      });
    }
    if (primitive.emission_texture >= 0) {
      patch.emission = mean([&](double u, double v) {
        const Color color = textured_emission(scene, patch.primitive, u, v);
        return Vec3d(color.x, color.y, color.z);
      });
    }
    if (primitive.shader < 0) continue;
    const Shader& source = scene.shaders[primitive.shader];
    MaterialShader& shader = shaders[primitive.shader];
    if (shader.reflects()) {
      ColorSource color{job, source, "reflectance", most_reflectance(scene.materials[primitive.material])};
      patch.reflectance = within_range(Vec3d(mean([&](double u, double v) {
                                         const auto at = shader_inputs(scene, patch.primitive, u, v);
                                         return color.checked(shader.reflectance(at), at);
                                       })),
                                       color.most);
      lowered[primitive.shader] |= color.lowered;
    }
    if (shader.emits()) {
      ColorSource color{job, source, "emission", Color(kMostEmission)};
      patch.emission = mean([&](double u, double v) {
        const auto at = shader_inputs(scene, patch.primitive, u, v);
        return color.checked(shader.emission(at), at);
      });
    }
    progress.update(static_cast<double>(i) / static_cast<double>(scene.patches.size()), "colours");
  }
  for (std::size_t i = 0; i < shaders.size(); ++i) {
    if (lowered[i] == 0) continue;
    progress.warning(
        fmt::format("reflectance of shader '{}' lowered to 0.99999, or to what a metallic part leaves, where it is "
                    "more: it would keep light forever",
                    scene.shaders[i].name));
  }
}

}  // namespace patchlight
