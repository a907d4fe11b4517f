#include "solver/error/quantiles.h"

#include <gtest/gtest.h>

namespace patchlight {
namespace {

TEST(Quantiles, OfTheFDistributionMatchTheTables) {
  // Numerator, denominator, 95% quantile (Abramowitz and Stegun 1964, table 26.9).
  const double table[][3]{{1, 10, 4.96}, {1, 120, 3.92}, {2, 20, 3.49}, {5, 5, 5.05},
                          {8, 8, 3.44},  {20, 20, 2.12}, {3, 60, 2.76}, {120, 120, 1.35}};
  for (const auto& [numerator, denominator, quantile] : table)
    EXPECT_NEAR(f_quantile_95(numerator, denominator), quantile, 0.03 * quantile) << numerator << ", " << denominator;
}

TEST(Quantiles, OfNearlyCertainSquaresAreOne) {
  EXPECT_NEAR(upper_ratio_95(0, 0), 1, 1e-3);
  EXPECT_NEAR(upper_ratio_95(2, 0), 3.84, 0.1) << "the square of one normal variate";
}

TEST(Quantiles, SpreadIsTheMeanAndTheRelativeVariance) {
  const Spread spread({1, 3});
  EXPECT_EQ(spread.mean, 2);
  EXPECT_EQ(spread.relative_variance, 0.5);
  EXPECT_EQ(Spread({4}).relative_variance, 0);
  EXPECT_EQ(Spread({0, 0}).relative_variance, 0);
}

}  // namespace
}  // namespace patchlight
