#pragma once
#include <vector>

#include "pipeline/job/expression.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// What a shader reads at (u,v) of primitive `i`: its u and v are the primitive's, or the mesh's texture coordinates.
ExpressionInputs shader_inputs(const PatchSet& scene, std::int32_t i, double u, double v);

/// A Shader with its expressions compiled. For one thread at a time; every copy gives the same bits.
class MaterialShader {
 public:
  /// Expects expressions that compile, as those of every PatchSet do.
  explicit MaterialShader(const Shader& source);

  bool reflects() const { return !reflectance_.empty(); }
  bool emits() const { return !emission_.empty(); }

  /// As the expressions say, in range or not. Zero without expressions.
  Vec3d reflectance(const ExpressionInputs& at) { return evaluate(reflectance_, at); }
  Vec3d emission(const ExpressionInputs& at) { return evaluate(emission_, at); }  ///< W/m2

 private:
  static Vec3d evaluate(std::vector<Expression>& color, const ExpressionInputs& at);

  std::vector<Expression> reflectance_;  ///< One for each channel, or one for all.
  std::vector<Expression> emission_;
};

std::vector<MaterialShader> compile_shaders(const PatchSet& scene);

constexpr float kHighestReflectance = 0.99999f;

/// The most that a surface may reflect diffusely beside its metallic part.
Color most_reflectance(const Material& material);

constexpr float kMostEmission = 3e38f;  // W/m2

/// Diffuse reflectance by a shader that reflects, at (u,v) of primitive `i`: in range beside its metallic part.
Color shaded_reflectance(const PatchSet& scene, MaterialShader& shader, std::int32_t i, double u, double v);

/// The value brought into [0, most]; 0 for what is not finite.
Color within_range(const Vec3d& value, const Color& most);

}  // namespace patchlight
