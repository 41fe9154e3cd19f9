// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/contact_cones.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace palpate::haptics {
namespace {

// A ball that presses on a block of finite elements whose points slip by Coulomb's law.
struct Press {
  double normal;  // [N]
  double depth;   // [mm]
  double limit;   // [N] tangential force from which on the ball slides
};
struct Ball {
  double radius;    // [mm]
  double friction;  // of each point
  std::vector<Press> presses;
};

// Equilibria of blocks, found as by `finite_element_validation slides` to 3 % of the normal force.
const std::vector<Ball> kBalls = {
    {5, 0.9, {{0.15, 0.408, 0.144}, {0.5, 0.878, 0.477}, {1.1, 1.452, 1.083}}},
    {5, 0.9, {{0.15, 0.735, 0.156}, {0.5, 1.550, 0.508}, {1.1, 2.532, 1.111}}},
    {5, 0.4, {{0.15, 0.397, 0.069}, {0.5, 0.884, 0.242}, {1.1, 1.434, 0.520}}},
};

const probing::Contact kConeContact{1, {0, 0, 700}, {0, 0, -1}};

// Bisections of the tangential force to `kInterval` in eight directions.
probing::Acquisition slides(const Ball& ball) {
  constexpr int kDirections = 8;
  constexpr double kInterval = 0.02;  // [N]
  probing::Acquisition result;
  result.contacts = {kConeContact};
  result.probe_radius = ball.radius;
  for (const Press& press : ball.presses) {
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2 * std::numbers::pi * i / kDirections;
      const Eigen::Vector3d across(std::cos(angle), std::sin(angle), 0);
      double held = 0, slipped = 1.5 * press.normal;
      while (slipped - held > kInterval) {
        const double tried = (held + slipped) / 2;
        const bool slips = tried > press.limit;
        const Eigen::Vector3d a = kConeContact.position - press.depth * kConeContact.normal;
        result.samples.push_back({.id = static_cast<long long>(result.samples.size()),
                                  .contact = kConeContact.id,
                                  .force = tried * across - press.normal * kConeContact.normal,
                                  .a = a,
                                  .b = a,
                                  .slipped = slips});
        (slips ? slipped : held) = tried;
      }
    }
  }
  return result;
}

FrictionFit cone_of(const probing::Acquisition& acquisition, double steady_error = 0.015) {
  const std::vector<std::size_t> source = {0};
  return fit_contact_cones(acquisition, source, {.steady_error = steady_error}).cones.front();
}

TEST(FitContactCones, TheirErrorsHoldTheFrictionOfASolidUnderABall) {
  for (const Ball& ball : kBalls) {
    const FrictionFit cone = cone_of(slides(ball));
    ASSERT_EQ(cone.stop, FrictionStop::converged);
    EXPECT_LT(cone.lower_bound, ball.friction);
    EXPECT_NEAR(cone.coefficient, ball.friction, 2 * cone.coefficient_error);
    EXPECT_GT(cone.lower_bound, 0.8 * ball.friction);  // of use
  }
}

TEST(FitContactCones, AddNothingForABallThatIsNotKnownOrExactCones) {
  probing::Acquisition acquisition = slides(kBalls.front());
  const FrictionFit exact = cone_of(acquisition, 0);
  acquisition.probe_radius.reset();
  const FrictionFit cone = cone_of(acquisition);
  // It is the ball that slips, at more than the friction of its points.
  EXPECT_GT(cone.lower_bound, 0.9);
  EXPECT_GT(exact.lower_bound, 0.9);
}

// The deeper the ball, the larger the contact; at the surface there is none.
TEST(FitContactCones, AddLessForAShallowDent) {
  Ball shallow = kBalls.front();
  for (Press& press : shallow.presses) press.depth *= 0.01;
  const FrictionFit deep = cone_of(slides(kBalls.front())), cone = cone_of(slides(shallow));
  EXPECT_EQ(cone.coefficient, deep.coefficient);
  EXPECT_LT(cone.coefficient_error, 0.5 * deep.coefficient_error);
  EXPECT_GT(cone.lower_bound, deep.lower_bound);
}

}  // namespace
}  // namespace palpate::haptics
