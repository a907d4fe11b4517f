#include "pipeline/job/expression.h"

#include <gmock/gmock.h>

#include <cmath>
#include <thread>
#include <vector>

namespace patchlight {
namespace {

double value(const std::string& text, const ExpressionInputs& at = {}) {
  return Expression(text)(at);
}

/// "CHARACTER: REASON".
std::string fault(const std::string& text) {
  try {
    const Expression expression(text);
    return "";
  } catch (const ExpressionFault& found) {
    return std::to_string(found.character) + ": " + found.reason;
  }
}

TEST(Expression, ReadsPointAndNormal) {
  const ExpressionInputs at{0.25, 0.5, {1, 2, 3}, {0.6, 0, -0.8}};
  EXPECT_EQ(value("u + 10*v", at), 5.25);
  EXPECT_EQ(value("x + 10*y + 100*z", at), 321);
  EXPECT_EQ(value("nx + ny - nz", at), 0.6 + 0.8);
  EXPECT_DOUBLE_EQ(value("(1+cos(4*pi*u))/2", at), 0.0);
  EXPECT_NEAR(value("_pi - pi", at), 0, 1e-12);
  EXPECT_EQ(value("u <= v ? 3 : 4", at), 3);
  EXPECT_EQ(value("1.0e-3", at), 1e-3);
}

TEST(Expression, FollowsItsInputs) {
  Expression expression("u^2 + v");
  for (const double u : {0.0, 1.0, 3.0}) EXPECT_EQ(expression({u, 1, {}, {}}), u * u + 1);
}

TEST(Expression, MayBeNotFinite) {
  EXPECT_TRUE(std::isinf(value("1/u")));
  EXPECT_TRUE(std::isnan(value("sqrt(u - 1)")));
}

TEST(Expression, FaultsPointAtTheCharacter) {
  EXPECT_EQ(fault("1+*u"), "3: Unexpected operator \"*\"");
  EXPECT_EQ(fault("u + foo(v)"), "5: Unexpected token \"foo\"");
  EXPECT_EQ(fault("sin(u"), "6: Missing parenthesis");
  EXPECT_EQ(fault("u+"), "3: Unexpected end of expression");
  EXPECT_EQ(fault("2*u)"), "4: Unexpected parenthesis \")\"");
  EXPECT_EQ(fault(""), "1: Expression is empty");
  EXPECT_EQ(fault("(1+cos(4*pi*u))/2"), "");
}

TEST(Expression, IsAFormulaAlone) {
  EXPECT_EQ(fault("u = 3").substr(0, 2), "3:");
  EXPECT_EQ(fault("u == 3"), "");
  EXPECT_EQ(fault("u >= 3 && v != 2"), "");
  EXPECT_EQ(fault("u, v").substr(0, 2), "2:");
  EXPECT_EQ(fault("max(u, v)"), "");
  EXPECT_EQ(fault("1 + \"a\"").substr(0, 2), "5:");
  EXPECT_EQ(fault(std::string(1025, '1')).substr(0, 5), "1025:");
  for (const char* text : {"-", "u v", "2u", "u:1", "u?1", "max()", "sin(1,2)", "\xff", "1e400", "rnd()"})
    EXPECT_NE(fault(text), "") << text;
  EXPECT_NE(fault(std::string("u\0", 2)), "");
}

TEST(Expression, KnowsWhetherItReadsUv) {
  EXPECT_TRUE(Expression("x + 0*v").reads_uv());
  EXPECT_TRUE(Expression("u").reads_uv());
  EXPECT_FALSE(Expression("x*ny + exp(0)").reads_uv());
}

TEST(Expression, GivesTheSameBitsInEveryThread) {
  const std::string text = "(1+sin(4*pi*u))/2*exp(-x*x)";
  std::vector<double> once;
  Expression expression(text);
  for (int i = 0; i < 1000; ++i) once.push_back(expression({i * 1e-3, 0, {i * 2e-3, 0, 0}, {}}));
  std::vector<std::vector<double>> results(4);
  std::vector<std::thread> threads;
  for (auto& result : results)
    threads.emplace_back([&] {
      Expression own(text);
      for (int i = 0; i < 1000; ++i) result.push_back(own({i * 1e-3, 0, {i * 2e-3, 0, 0}, {}}));
    });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_EQ(result, once);
}

}  // namespace
}  // namespace patchlight
