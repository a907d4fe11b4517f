#include "pipeline/driver/bench/bench_variants.h"

#include <gmock/gmock.h>

#include <cmath>

namespace patchlight {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> names(const std::vector<SweepGrid>& sweep) {
  std::vector<std::string> result;
  for (const Variant& variant : bench_variants(sweep)) result.push_back(variant.name);
  return result;
}

TEST(BenchVariants, AreEveryCombinationOfEveryGrid) {
  EXPECT_THAT(names({{{"solve.rays", {"16", "64"}}, {"import.patch_area", {"1e-3", "1e-4"}}}, {{"solve.seed", {"7"}}}}),
              ElementsAre("rays=16,patch_area=1e-3", "rays=16,patch_area=1e-4", "rays=64,patch_area=1e-3",
                          "rays=64,patch_area=1e-4", "seed=7"));
}

TEST(BenchVariants, HaveFoldersOfTheirOwnWithHarmlessNames) {
  EXPECT_THAT(names({{{"trace.cameras", {"[a/b]", "[a b]"}}},
                     {{"trace.view", {"../../x"}}},
                     {{"solve.rays", {"1"}}},
                     {{"solve.rays", {"1"}}}}),
              ElementsAre("cameras=_a_b_", "cameras=_a_b__2", "view=.._.._x", "rays=1", "rays=1_2"));
}

TEST(BenchVariants, TellKeysApartThatEndAlike) {
  const std::vector<SweepGrid> sweep{{{"lights.a.scale", {"1"}}, {"lights.\"b.c\".scale", {"2"}}}};
  EXPECT_EQ(bench_variants(sweep)[0].label, "lights.a.scale 1, lights.\"b.c\".scale 2");
  EXPECT_EQ(short_key({{{"lights.\"b.c\"", {"2"}}}}, "lights.\"b.c\""), "\"b.c\"");
}

TEST(ParetoFront, HoldsWhatNothingElseBeats) {
  EXPECT_THAT(pareto_front({{3, 1}, {1, 3}, {2, 2}, {2, 3}, {4, 1}, {3, 2}}), ElementsAre(1, 2, 0));
}

TEST(ParetoFront, HoldsEqualPointsAndNothingThatIsNotFinite) {
  EXPECT_THAT(pareto_front({{1, 1}, {1, 1}, {0.5, NAN}, {INFINITY, 0}}), ElementsAre(0, 1));
  EXPECT_TRUE(pareto_front({}).empty());
}

}  // namespace
}  // namespace patchlight
