#pragma once
#include <gtest/gtest.h>

#include "pipeline/model/math.h"

namespace patchlight::test {

inline void expect_color(const Color& actual, const Vec3d& expected, double tolerance = 1e-6) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], expected[i], tolerance * (1 + expected[i]));
}

}  // namespace patchlight::test
