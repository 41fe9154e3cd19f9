// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/local_fit.h"

#include <gtest/gtest.h>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

// A valley whose energy is negative from 4.3 on, measured up to 2.
FieldObjective measured_valley() {
  FieldObjective objective;
  objective.displacements = random_points(60, 2);
  objective.forces = forces_at(valley(), objective.displacements);
  objective.weight_penalty = 1e-9;
  return objective;
}

LocalFitOptions two_bases() {
  LocalFitOptions options;
  options.max_bases = 2;
  options.epsilon = 1.5;
  options.constraints.free_epsilon = true;
  return options;
}

TEST(FitCertified, RepairsWhatTheLocalFitLosesFarFromTheData) {
  const ReachableVolume volume{6};
  const LocalFit local = fit_local(measured_valley(), two_bases());
  const PassivityCertificate before = certify_passivity(local.field, volume);
  ASSERT_EQ(before.passivity, Passivity::violated);
  const CertifiedFit certified = fit_certified(measured_valley(), two_bases(), volume);
  EXPECT_TRUE(is_passive(certified.certificate));
  EXPECT_GT(certified.repairs, 0);
  EXPECT_GE(potential(certified.fit.field, before.weakest), 0);
  const Eigen::Matrix3Xd places = random_points(20000, volume.radius, 3);
  for (const auto& place : places.colwise()) {
    EXPECT_GE(potential(certified.fit.field, place), 0);
  }
  // The fit still follows the data: forces are near 0.5.
  EXPECT_LT(certified.fit.rms, 0.05);
}

TEST(FitCertified, LeavesWhatIsPassiveAlone) {
  const ReachableVolume near{2};
  const CertifiedFit certified = fit_certified(measured_valley(), two_bases(), near);
  EXPECT_TRUE(is_passive(certified.certificate));
  EXPECT_EQ(certified.repairs, 0);
  EXPECT_LT(certified.fit.rms, 0.01);
}

TEST(FitCertified, IsPassiveAndAsGoodInAnyFrame) {
  const Eigen::Matrix3Xd at_places =
      forces_at(fit_certified(measured_valley(), two_bases(), {2}).fit.field,
                measured_valley().displacements);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) {
    turn = turn * some_rotation();
    FieldObjective turned = measured_valley();
    turned.displacements = turn * turned.displacements;
    turned.forces = turn * turned.forces;
    const CertifiedFit near = fit_certified(turned, two_bases(), {2});
    EXPECT_TRUE(is_passive(near.certificate));
    const Eigen::Matrix3Xd back =
        turn.transpose() * forces_at(near.fit.field, turned.displacements);
    EXPECT_LT((back - at_places).norm(), 0.01 * at_places.norm());
    // Which of the places that violate passivity is found, and so the repair, depends on the frame.
    const CertifiedFit far = fit_certified(turned, two_bases(), {6});
    EXPECT_TRUE(is_passive(far.certificate));
    EXPECT_LT(far.fit.rms, 0.05);
  }
}

}  // namespace
}  // namespace palpate::haptics
