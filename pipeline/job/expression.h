#pragma once
#include <cstddef>
#include <memory>
#include <string>

#include "pipeline/model/math.h"

namespace patchlight {

/// The point of a surface that an expression is evaluated at.
struct ExpressionInputs {
  double u = 0, v = 0;
  Vec3d position{0.0};  ///< x, y, z: m, world space.
  Vec3d normal{0.0};    ///< nx, ny, nz: unit.
};

/// Why a text is no expression, and where.
struct ExpressionFault {
  std::string reason;
  std::size_t character = 1;  ///< Counts from 1; one more than the text has: at its end.
};

constexpr std::size_t kLongestExpression = 1024;  // bytes; what patches.h5 holds

/// A formula of u, v, x, y, z, nx, ny, nz and pi, compiled by muParser. For one thread at a time; copies of the same
/// text give the same bits.
class Expression {
 public:
  /// Throws: ExpressionFault.
  explicit Expression(const std::string& text);
  ~Expression();
  Expression(Expression&&) noexcept;

  /// Not finite where the formula is not.
  double operator()(const ExpressionInputs& at);

  bool reads_uv() const;

 private:
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

}  // namespace patchlight
