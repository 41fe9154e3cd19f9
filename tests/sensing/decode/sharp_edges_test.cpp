// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/sharp_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "decode/plausibility.h"

namespace palpate::sensing {
namespace {

constexpr long kSharpSize = 24;       // px
constexpr double kSurfaceEdge = 7.5;  // of a surface on the columns behind it
constexpr int kSharpRadius = 2;       // px

/// Light of a surface whose edge is blurred.
Plane surface(double blur) {
  Plane light(kSharpSize, kSharpSize);
  for (long column = 0; column < kSharpSize; ++column) {
    const double behind = static_cast<double>(column) - kSurfaceEdge;
    light.col(column).setConstant(
        static_cast<float>(std::erfc(-behind / (blur * std::numbers::sqrt2)) / 2));
  }
  return light;
}

/// The first column that is kept of a surface that is seen where its light is above 2 %.
long first_kept(const Plane& light) {
  const Mask lit = (light > 0.02F).cast<std::uint8_t>();
  Mask inner;
  erode(lit, kSharpRadius, inner);
  keep_sharp_edges({{light, light, light}}, lit, kSharpRadius, inner);
  for (long column = 0; column < kSharpSize; ++column) {
    EXPECT_TRUE((inner.col(column) == inner(0, column)).all()) << column;
    if (inner(0, column) != 0) return column;
  }
  return kSharpSize;
}

TEST(SharpEdges, LoseTheirOutermostPixelAlone) { EXPECT_EQ(first_kept(surface(0.01)), 8 + 1); }

TEST(SharpEdges, LoseWhatBlurReachesAsBefore) {
  for (const double blur : {0.7, 1.0, 1.5}) {
    const Plane light = surface(blur);
    long first_lit = 0;
    while (light(0, first_lit) <= 0.02F) ++first_lit;
    EXPECT_EQ(first_kept(light), first_lit + kSharpRadius) << blur;
  }
}

TEST(SharpEdges, AreNotThoseOfDarkPrint) {
  Plane light = surface(0.01);
  light.leftCols(10) *= 0.9F;
  EXPECT_EQ(first_kept(light), 8 + kSharpRadius);
}

TEST(SharpEdges, AreKnownAtTheBorderOfTheImage) {
  const Plane light = Plane::Ones(3, 3);
  const Mask lit = Mask::Ones(3, 3);
  Mask inner = Mask::Zero(3, 3);
  keep_sharp_edges({{light, light, light}}, lit, kSharpRadius, inner);
  EXPECT_TRUE((inner == 1).all());
}

}  // namespace
}  // namespace palpate::sensing
