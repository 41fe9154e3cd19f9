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

constexpr double kFoamTolerance = 1e-12;  // relative, some ten operations

const probing::Contact kFoamContact{3, {1, 2, 3}, Eigen::Vector3d(0.2, -0.3, -0.9).normalized()};
const HalfSpaceModel kFoam{0.05, 0.3, 4};

TEST(HalfSpaceModel, IsThePunchOfBoussinesqAlongTheNormal) {
  const Eigen::Vector3d pressed = force(kFoam, kFoamContact, -0.7 * kFoamContact.normal);
  EXPECT_NEAR(pressed.dot(-kFoamContact.normal), 2 * 4 * 0.05 / (1 - 0.09) * 0.7, kFoamTolerance);
  EXPECT_NEAR(pressed.cross(kFoamContact.normal).norm(), 0, kFoamTolerance);
}

TEST(HalfSpaceModel, IsAsStiffSidewaysAsAlongTheNormalWithoutTransverseContraction) {
  EXPECT_TRUE(stiffness({0.05, 0, 4}, kFoamContact)
                  .isApprox(2 * 4 * 0.05 * Eigen::Matrix3d::Identity(), kFoamTolerance));
}

TEST(HalfSpaceModel, IsTwoThirdsAsStiffSidewaysIfIncompressible) {
  const Eigen::Matrix3d k = stiffness({0.05, 0.5, 4}, kFoamContact);
  const Eigen::Vector3d sideways = kFoamContact.normal.unitOrthogonal();
  EXPECT_NEAR(sideways.dot(k * sideways) / kFoamContact.normal.dot(k * kFoamContact.normal),
              2.0 / 3, kFoamTolerance);
}

TEST(HalfSpaceModel, HasTheForceOfItsEnergyAndItsInverse) {
  const Eigen::Vector3d at(0.4, -1.1, 0.8);
  constexpr double kStep = 1e-4;  // exact for a quadratic up to rounding
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(k);
    EXPECT_NEAR((potential(kFoam, kFoamContact, at + d) - potential(kFoam, kFoamContact, at - d)) /
                    (2 * kStep),
                force(kFoam, kFoamContact, at)[k], 1e-10);
  }
  EXPECT_TRUE(displacement(kFoam, kFoamContact, force(kFoam, kFoamContact, at))
                  .isApprox(at, kFoamTolerance));
}

TEST(HalfSpaceModel, RefusesWhatIsNoMaterial) {
  const std::vector<std::pair<HalfSpaceModel, std::string>> cases = {
      {{0, 0.3, 4}, "young_modulus is 0"},
      {{0.05, 0.6, 4}, "poisson_ratio is 0.6"},
      {{0.05, -1, 4}, "poisson_ratio is -1"},
      {{0.05, 0.3, 0}, "tool_radius is 0"},
      {{std::nan(""), 0.3, 4}, "young_modulus is nan"}};
  for (const auto& [wrong, words] : cases) {
    const HalfSpaceModel& model = wrong;
    EXPECT_THAT(refusal([&] { return stiffness(model, kFoamContact); }),
                ::testing::HasSubstr(words));
  }
}

}  // namespace
}  // namespace palpate::haptics
