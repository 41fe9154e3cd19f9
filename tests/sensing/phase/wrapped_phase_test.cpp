// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/wrapped_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace palpate::sensing {
namespace {

float angle_of(float re, float im) {
  Plane wrapped;
  find_wrapped_phase(Plane::Constant(1, 1, re), Plane::Constant(1, 1, im), wrapped);
  return wrapped(0, 0);
}

TEST(WrappedPhase, IsTheArcTangentAllAroundTheCircle) {
  constexpr double kBound = 4e-7;
  constexpr int kAngles = 100003;
  Plane re(1, kAngles);
  Plane im(1, kAngles);
  for (int i = 0; i < kAngles; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAngles;
    const double length = std::pow(10.0, i % 13 - 6);
    re(0, i) = static_cast<float>(length * std::cos(angle));
    im(0, i) = static_cast<float>(length * std::sin(angle));
  }
  Plane wrapped;
  find_wrapped_phase(re, im, wrapped);
  for (int i = 0; i < kAngles; ++i) {
    const double exact = std::atan2(static_cast<double>(im(0, i)), static_cast<double>(re(0, i)));
    ASSERT_NEAR(static_cast<double>(wrapped(0, i)), exact, kBound) << re(0, i) << ' ' << im(0, i);
  }
}

TEST(WrappedPhase, OfTheAxesAndOfNothing) {
  constexpr float kPi = std::numbers::pi_v<float>;
  EXPECT_FLOAT_EQ(angle_of(2, 0), 0);
  EXPECT_FLOAT_EQ(angle_of(0, 3), kPi / 2);
  EXPECT_FLOAT_EQ(angle_of(0, -3), -kPi / 2);
  EXPECT_FLOAT_EQ(angle_of(-1, 0), kPi);
  EXPECT_EQ(angle_of(0, 0), 0);
  EXPECT_TRUE(std::isnan(angle_of(std::numeric_limits<float>::quiet_NaN(), 1)));
}

}  // namespace
}  // namespace palpate::sensing
