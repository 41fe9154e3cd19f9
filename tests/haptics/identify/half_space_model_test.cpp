// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/half_space_model.h"

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

constexpr double kTol = 1e-12;  // relative, some ten operations

const probing::Contact kContact{3, {1, 2, 3}, Eigen::Vector3d(0.2, -0.3, -0.9).normalized()};
const HalfSpaceModel kFoam{0.05, 0.3, 4};

TEST(HalfSpaceModel, IsThePunchOfBoussinesqAlongTheNormal) {
  const Eigen::Vector3d pressed = force(kFoam, kContact, -0.7 * kContact.normal);
  EXPECT_NEAR(pressed.dot(-kContact.normal), 2 * 4 * 0.05 / (1 - 0.09) * 0.7, kTol);
  EXPECT_NEAR(pressed.cross(kContact.normal).norm(), 0, kTol);
}

TEST(HalfSpaceModel, IsAsStiffSidewaysAsAlongTheNormalWithoutTransverseContraction) {
  EXPECT_TRUE(
      stiffness({0.05, 0, 4}, kContact).isApprox(2 * 4 * 0.05 * Eigen::Matrix3d::Identity(), kTol));
}

TEST(HalfSpaceModel, IsTwoThirdsAsStiffSidewaysIfIncompressible) {
  const Eigen::Matrix3d k = stiffness({0.05, 0.5, 4}, kContact);
  const Eigen::Vector3d sideways = kContact.normal.unitOrthogonal();
  EXPECT_NEAR(sideways.dot(k * sideways) / kContact.normal.dot(k * kContact.normal), 2.0 / 3, kTol);
}

TEST(HalfSpaceModel, HasTheForceOfItsEnergyAndItsInverse) {
  const Eigen::Vector3d at(0.4, -1.1, 0.8);
  constexpr double kStep = 1e-4;  // exact for a quadratic but for rounding
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(k);
    EXPECT_NEAR(
        (potential(kFoam, kContact, at + d) - potential(kFoam, kContact, at - d)) / (2 * kStep),
        force(kFoam, kContact, at)[k], 1e-10);
  }
  EXPECT_TRUE(displacement(kFoam, kContact, force(kFoam, kContact, at)).isApprox(at, kTol));
}

TEST(HalfSpaceModel, RefusesWhatIsNoMaterial) {
  const std::vector<std::pair<HalfSpaceModel, std::string>> cases = {
      {{0, 0.3, 4}, "young_modulus is 0"},
      {{0.05, 0.6, 4}, "poisson_ratio is 0.6"},
      {{0.05, -1, 4}, "poisson_ratio is -1"},
      {{0.05, 0.3, 0}, "tool_radius is 0"},
      {{std::nan(""), 0.3, 4}, "young_modulus is nan"}};
  for (const auto& [model, words] : cases) {
    EXPECT_THAT(refusal([&] { return stiffness(model, kContact); }), ::testing::HasSubstr(words));
  }
}

}  // namespace
}  // namespace palpate::haptics
