#pragma once
#include <vector>

#include "pipeline/job/expression.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Inputs of a shader at (u,v) of primitive `i`. The shader's u and v are texture coordinates, or (u,v) without any.
ExpressionInputs shader_inputs(const PatchSet& scene, std::int32_t i, double u, double v);

/// A Shader with compiled expressions. Not thread-safe; copies give bit-identical results.
class MaterialShader {
 public:
  /// The expressions must compile, as in every valid PatchSet.
  explicit MaterialShader(const Shader& source);

  bool reflects() const { return !reflectance_.empty(); }
  bool emits() const { return !emission_.empty(); }

  /// Values of the expressions, not limited to the valid range. Zero without expressions.
  Vec3d reflectance(const ExpressionInputs& at) { return evaluate(reflectance_, at); }
  Vec3d emission(const ExpressionInputs& at) { return evaluate(emission_, at); }  ///< W/m2

 private:
  static Vec3d evaluate(std::vector<Expression>& color, const ExpressionInputs& at);

  std::vector<Expression> reflectance_;  ///< Three, or one for all channels.
  std::vector<Expression> emission_;
};

std::vector<MaterialShader> compile_shaders(const PatchSet& scene);

constexpr float kMaxReflectance = 0.99999f;

/// Upper limit of the diffuse reflectance: what the specular reflectance and the translucence leave.
Color max_diffuse_reflectance(const Material& material);

constexpr float kMaxEmission = 3e38f;  // W/m2

/// Diffuse reflectance by a shader with reflectance expressions at (u,v) of primitive `i`, limited by
/// max_diffuse_reflectance().
Color shaded_reflectance(const PatchSet& scene, MaterialShader& shader, std::int32_t i, double u, double v);

/// Clamps every channel to [0, highest]; 0 for NaN and infinities.
Color clamp_color(const Vec3d& value, const Color& highest);

}  // namespace patchlight
