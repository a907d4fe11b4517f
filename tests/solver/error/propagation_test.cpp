#include <gtest/gtest.h>

#include "solver/error/consistency.h"
#include "solver/error/error_propagation.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

/// Two squares that see nothing but each other.
struct FacingSquares {
  test::PatchScene builder;
  TransportRows transport;
  FormFactorRows rows;
  std::vector<double> areas{1, 1};
  Scattering scattering;

  explicit FacingSquares(double rho)
      : transport{{0, 1, 2, 3, 4}, {1, 1, 0, 0}, {}, {1, 1, 1, 1}, {}, {}, 2, {}, {}, {}},
        rows(transport),
        scattering{SpectrumField(2, Spectrum(rho))} {
    builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 1, 1, {float(rho), 1.0f});
    builder.quad({{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}}, 1, 1, {float(rho)});
  }
};

TEST(ErrorPropagation, SolvesForWhatReachesOtherPatches) {
  const FacingSquares squares(0.5);
  const ErrorPropagation propagation(squares.rows, squares.scattering, squares.areas);
  const SpectrumField p = propagation.propagate({Spectrum(1.0), Spectrum(0.0)});
  EXPECT_NEAR(p[0].c[0], 1.0 / 3, 0.02);  // p0 = p1 / 2, p1 = (1 + p0) / 2
  EXPECT_NEAR(p[1].c[0], 2.0 / 3, 0.02);
}

TEST(ErrorPropagation, SolvesSafelyWhereTheSystemAmplifies) {
  const FacingSquares squares(0.999);
  const ErrorPropagation propagation(squares.rows, squares.scattering, squares.areas);
  const SpectrumField p = propagation.propagate_safely({Spectrum(1.0), Spectrum(0.9)}, 0.0);
  for (const Spectrum& at : p) EXPECT_NEAR(at.c[1], 0.95 * 999, 0.1 * 999);
  EXPECT_EQ(propagation.norm(propagation.propagate_safely(SpectrumField(2), 0.0)), 0);
}

TEST(EnergyBalance, IsThePowerThatIsMissing) {
  const FacingSquares squares(0.5);
  FacingSquares scene(0.5);
  const SpectrumField exact{Spectrum(2.0 / 3), Spectrum(4.0 / 3)}, lacking{Spectrum(1.0 / 3), Spectrum(4.0 / 3)};
  const auto balance = [&](const SpectrumField& irradiance) {
    return EnergyBalance(scene.builder.get(), squares.rows, squares.areas, squares.scattering, SpectrumField(2),
                         irradiance);
  };
  EXPECT_NEAR(balance(exact).error(), 0, 1e-12);
  EXPECT_NEAR(balance(lacking).error(), 1.0 / 6, 1e-12);  // of a third, half is reflected and arrives
  EXPECT_NEAR(balance(lacking).missing_power(SpectrumField(2)).c[0], 1.0 / 6, 1e-12);
  EXPECT_NEAR(balance(lacking).missing_power({Spectrum(1.0 / 3), Spectrum(0.0)}).c[0], 0, 1e-12);
}

}  // namespace
}  // namespace patchlight
