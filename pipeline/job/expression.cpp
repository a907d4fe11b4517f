#include "pipeline/job/expression.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <string_view>

namespace patchlight {

namespace {

/// muParser also accepts assignments, strings and lists of values, which are refused.
void refuse_more_than_a_formula(const std::string& text) {
  if (text.size() > kLongestExpression)
    throw ExpressionFault{fmt::format("more than {} characters", kLongestExpression), kLongestExpression + 1};
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto refuse = [i](const char* reason) { throw ExpressionFault{reason, i + 1}; };
    if (c == '\0' || c == '"') refuse("neither a formula's nor a number's");
    if (c == '(') ++depth;
    if (c == ')') --depth;
    if (c == ',' && depth == 0) refuse("one value is wanted, not a list");
    if (c != '=') continue;
    if (i + 1 < text.size() && text[i + 1] == '=')
      ++i;
    else if (i == 0 || std::string_view("<>!").find(text[i - 1]) == std::string_view::npos)
      refuse("nothing can be assigned; compare with ==");
  }
}

/// muParser's message without its position, which counts from 0.
ExpressionFault fault_of(const mu::ParserError& error, const std::string& text) {
  std::string reason = error.GetCode() == mu::ecINTERNAL_ERROR ? "Not a formula" : error.GetMsg();
  for (const char* place : {" found at position", " at position", " at expression position"})
    reason = reason.substr(0, reason.find(place));
  if (reason.ends_with('.')) reason.pop_back();
  const std::size_t position = error.GetPos() < 0 ? text.size() : std::size_t(error.GetPos());
  return {reason, std::min(position, text.size()) + 1};
}

}  // namespace

struct Expression::Compiled {
  ExpressionInputs at;
  mu::Parser parser;
  bool reads_uv = false;

  explicit Compiled(const std::string& text) {
    refuse_more_than_a_formula(text);
    parser.DefineConst("pi", kPi);
    parser.DefineVar("u", &at.u);
    parser.DefineVar("v", &at.v);
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      parser.DefineVar(name, &at.position[axis]);
      parser.DefineVar("n" + name, &at.normal[axis]);
    }
    parser.SetExpr(text);
    parser.Eval();  // compiles
    const mu::varmap_type& used = parser.GetUsedVar();
    reads_uv = used.contains("u") || used.contains("v");
    parser.Eval();  // GetUsedVar discards the compiled formula
  }
};

Expression::Expression(const std::string& text) {
  try {
    compiled_ = std::make_unique<Compiled>(text);
  } catch (const mu::ParserError& error) {
    throw fault_of(error, text);
  }
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;

double Expression::operator()(const ExpressionInputs& at) {
  compiled_->at = at;
  return compiled_->parser.Eval();
}

bool Expression::reads_uv() const {
  return compiled_->reads_uv;
}

}  // namespace patchlight
