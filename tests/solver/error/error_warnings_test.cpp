#include "solver/error/error_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patchlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

EnergyField::Estimate estimate(double bound, double residual, double balance) {
  EnergyField::Estimate result;
  result.error = 0.5 * bound;
  result.error_bound = bound;
  result.error_residual = residual;
  result.balance = balance;
  return result;
}

TEST(ErrorWarnings, AreSilentBelowTheirLimits) {
  EXPECT_THAT(error_warnings({}, estimate(0.05, 0, 0.01)), IsEmpty());
}

TEST(ErrorWarnings, AskForAsManyRaysAsTheBoundNeeds) {
  SolveConfig config;
  config.rays = 64;
  EXPECT_THAT(error_warnings(config, estimate(0.1, 0.01, 0)),
              ElementsAre("the error may reach 10%: raise solve.rays (now 64) to about 256"));
}

TEST(ErrorWarnings, AskForASmallerToleranceWhereTheResidualPrevails) {
  SolveConfig config;
  config.tolerance = 0.1;
  EXPECT_THAT(error_warnings(config, estimate(0.1, 0.04, 0)),
              ElementsAre(HasSubstr("lower solve.tolerance (now 0.1)")));
}

TEST(ErrorWarnings, AskForSmallerPatchesWhereThesePrevail) {
  EnergyField::Estimate coarse = estimate(0.1, 0, 0);
  coarse.error_patches = 0.045;
  const std::string want = "the error may reach 10%: the patches are too coarse for the light; lower import.patch_area";
  EXPECT_THAT(error_warnings({}, coarse), ElementsAre(want));
  SolveConfig config;
  config.error_target = 0.02;
  EXPECT_THAT(error_warnings(config, coarse), ElementsAre(want));
  EXPECT_THAT(error_warnings(config, estimate(0.1, 0, 0.02)), IsEmpty()) << "the solve has told why it stopped";
}

TEST(ErrorWarnings, NameTheBalance) {
  SolveConfig config;
  config.rays = 32;
  EXPECT_THAT(error_warnings(config, estimate(0.01, 0, 0.02)),
              ElementsAre("the energy balance is 2% off: raise solve.rays (now 32) to about 128"));
}

TEST(ErrorWarnings, AskForFinerHemicubes) {
  SolveConfig config;
  config.form_factors = "hemicube";
  EXPECT_THAT(error_warnings(config, estimate(0.1, 0, 0)),
              ElementsAre("the error may reach 10%: raise solve.hemicube_resolution (now 128)"));
}

}  // namespace
}  // namespace patchlight
