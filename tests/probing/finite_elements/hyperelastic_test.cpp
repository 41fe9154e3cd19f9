// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/hyperelastic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

const Hyperelastic kRubber{.shear_modulus = 0.7, .bulk_modulus = 5, .mooney_share = 0.3};
const Eigen::Matrix3d kStretched{{1.3, 0.2, -0.1}, {0.15, 0.8, 0.3}, {-0.2, 0.1, 1.1}};

TEST(Hyperelastic, StressIsTheDerivativeOfTheEnergy) {
  constexpr double kStep = 1e-5, kTruncation = 1e-9;
  const Eigen::Matrix3d stress = isochoric_stress(kRubber, kStretched).stress;
  for (int k = 0; k < 9; ++k) {
    Eigen::Matrix3d more = kStretched, less = kStretched;
    more(k) += kStep;
    less(k) -= kStep;
    EXPECT_NEAR(stress(k),
                (isochoric_energy(kRubber, more) - isochoric_energy(kRubber, less)) / (2 * kStep),
                kTruncation);
  }
}

TEST(Hyperelastic, TangentIsTheDerivativeOfTheStress) {
  constexpr double kStep = 1e-5, kTruncation = 1e-8;
  const auto tangent = isochoric_stress(kRubber, kStretched).tangent;
  EXPECT_LT((tangent - tangent.transpose()).norm(), 1e-14 * tangent.norm());
  for (int k = 0; k < 9; ++k) {
    Eigen::Matrix3d more = kStretched, less = kStretched;
    more(k) += kStep;
    less(k) -= kStep;
    const Eigen::Matrix3d expected =
        (isochoric_stress(kRubber, more).stress - isochoric_stress(kRubber, less).stress) /
        (2 * kStep);
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(tangent(i, k), expected(i), kTruncation);
  }
}

TEST(Hyperelastic, DoesNotDependOnRotationsOrTheVolume) {
  const Eigen::Matrix3d turn{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
  const double energy = isochoric_energy(kRubber, kStretched);
  EXPECT_NEAR(isochoric_energy(kRubber, turn * kStretched), energy, 1e-14);
  EXPECT_NEAR(isochoric_energy(kRubber, 1.7 * kStretched), energy, 1e-14);
}

TEST(Hyperelastic, IsLinearElasticAtSmallStrains) {
  const auto tangent = isochoric_stress(kRubber, Eigen::Matrix3d::Identity()).tangent;
  EXPECT_NEAR(tangent(0, 0), 4.0 / 3 * kRubber.shear_modulus, 1e-12);   // xx by xx
  EXPECT_NEAR(tangent(0, 4), -2.0 / 3 * kRubber.shear_modulus, 1e-12);  // xx by yy
  EXPECT_NEAR(tangent(1, 3), kRubber.shear_modulus, 1e-12);             // yx by xy
  EXPECT_NEAR(volumetric_stress(kRubber, 1).tangent, kRubber.bulk_modulus, 1e-12);
  EXPECT_NEAR(young_modulus(kRubber), 2 * kRubber.shear_modulus * (1 + poisson_ratio(kRubber)),
              1e-12);
}

TEST(Hyperelastic, CofactorTurnsAreas) {
  const Eigen::Matrix3d expected = kStretched.determinant() * kStretched.inverse().transpose();
  EXPECT_LT((cofactor(kStretched) - expected).norm(), 1e-14);
}

TEST(Hyperelastic, RefusesWhatCannotBeSolved) {
  EXPECT_NO_THROW(check_hyperelastic({.shear_modulus = 1, .bulk_modulus = 1e4}));
  EXPECT_THROW(check_hyperelastic({.shear_modulus = 1, .bulk_modulus = 1.1e4}), InvalidInput);
  EXPECT_THROW(check_hyperelastic({.shear_modulus = -1}), InvalidInput);
  EXPECT_THROW(check_hyperelastic({.mooney_share = 1.5}), InvalidInput);
  EXPECT_THROW(check_hyperelastic({.shear_modulus = std::nan("")}), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
