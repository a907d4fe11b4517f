#pragma once
#include <cstddef>
#include <memory>
#include <string>

#include "pipeline/model/math.h"

namespace patchlight {

/// The surface point at which an expression is evaluated.
struct ExpressionInputs {
  double u = 0, v = 0;
  Vec3d position{0.0};  ///< x, y, z: m, world space.
  Vec3d normal{0.0};    ///< nx, ny, nz: unit.
};

/// Why a text is not a valid expression, and where.
struct ExpressionFault {
  std::string reason;
  std::size_t character = 1;  ///< Counts from 1; length + 1: at the end of the text.
};

constexpr std::size_t kLongestExpression = 1024;  // bytes; strings in patches.h5 are limited to it

/// A formula of u, v, x, y, z, nx, ny, nz and pi, compiled by muParser. Not thread-safe. Equal texts give bit-identical
/// results.
class Expression {
 public:
  /// Throws: ExpressionFault.
  explicit Expression(const std::string& text);
  ~Expression();
  Expression(Expression&&) noexcept;

  /// The value, which may be infinite or NaN.
  double operator()(const ExpressionInputs& at);

  bool reads_uv() const;

 private:
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

}  // namespace patchlight
