// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/passivity_certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "field/mixed_field.h"
#include "haptics_testing.h"
#include "not_finite.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

// The radius at which `valley` ends.
double valley_radius() {
  double inside = 1, outside = 20;
  for (int i = 0; i < 60; ++i) {
    const double middle = (inside + outside) / 2;
    const double energy = std::hypot(middle, 1) - 1 - 1.5 * (std::hypot(middle, 3) - 3);
    (energy > 0 ? inside : outside) = middle;
  }
  return inside;
}

double lowest_sample(const ForceField& field, double radius) {
  double lowest = std::numeric_limits<double>::infinity();
  const Eigen::Matrix3Xd places = random_points(20000, radius, 7);
  for (const auto& place : places.colwise()) {
    lowest = std::min(lowest, potential(field, place));
  }
  return lowest;
}

TEST(CertifyPassivity, NeedsNoSearchWithoutNegativeWeights) {
  ForceField field = mixed_field(6, 1);
  for (Multiquadric& base : field.bases) base.weight = std::abs(base.weight);
  const PassivityCertificate certificate = certify_passivity(field, {1e6});
  EXPECT_EQ(certificate.passivity, Passivity::convex);
  EXPECT_EQ(certificate.cells, 0);
  EXPECT_EQ(certify_passivity({}, {1}).passivity, Passivity::convex);
}

TEST(CertifyPassivity, FindsTheRadiusWhereAValleyEnds) {
  const double radius = valley_radius();
  const PassivityCertificate inside = certify_passivity(valley(), {0.9 * radius});
  EXPECT_EQ(inside.passivity, Passivity::certified);
  EXPECT_GT(inside.weakest_stiffness, 0);
  EXPECT_EQ(inside.volume.radius, 0.9 * radius);
  const PassivityCertificate outside = certify_passivity(valley(), {1.02 * radius});
  EXPECT_EQ(outside.passivity, Passivity::violated);
  EXPECT_LT(potential(valley(), outside.weakest), 0);
  EXPECT_LE(outside.weakest.norm(), 1.02 * radius);
  EXPECT_GT(outside.weakest.norm(), radius);
  EXPECT_LT(outside.weakest_stiffness, 0);
}

TEST(CertifyPassivity, FindsTheSameAlongARidge) {
  const Eigen::Vector3d along = Eigen::Vector3d(1, -2, 0.5).normalized();
  ForceField field = valley();
  for (Multiquadric& base : field.bases) base.ridge = along;
  // Across the ridges nothing else would resist.
  field.bases.push_back({0.03, 1, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  const double radius = valley_radius();
  EXPECT_EQ(certify_passivity(field, {0.8 * radius}).passivity, Passivity::certified);
  const PassivityCertificate outside = certify_passivity(field, {1.3 * radius});
  EXPECT_EQ(outside.passivity, Passivity::violated);
  EXPECT_GT(std::abs(outside.weakest.dot(along)), radius);
}

TEST(CertifyPassivity, AgreesWithDenseSampling) {
  int certified = 0, violated = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const ForceField field = mixed_field(6, seed);
    const PassivityCertificate certificate = certify_passivity(field, {10});
    switch (certificate.passivity) {
      case Passivity::convex:
        break;
      case Passivity::certified:
        ++certified;
        EXPECT_GE(lowest_sample(field, 10), 0) << seed;
        EXPECT_GE(lowest_sample(with_changed_numbers(field, 1e-6, seed), 10), 0) << seed;
        break;
      case Passivity::violated:
        ++violated;
        EXPECT_LT(potential(field, certificate.weakest), 0) << seed;
        EXPECT_LE(certificate.weakest.norm(), 10) << seed;
        break;
      case Passivity::undecided:
        ADD_FAILURE() << seed << ": " << certificate.cells << " cells";
    }
  }
  EXPECT_GT(certified, 10);
  EXPECT_GT(violated, 3);
}

TEST(CertifyPassivity, HoldsWhenAllNumbersChangeByTheirTolerance) {
  // Near the end of the valley there is no margin for changes of 1e-3.
  const double radius = valley_radius();
  EXPECT_EQ(certify_passivity(valley(), {0.95 * radius}).passivity, Passivity::certified);
  const CertificateOptions coarse{.number_tolerance = 1e-3};
  EXPECT_EQ(certify_passivity(valley(), {0.95 * radius}, coarse).passivity, Passivity::undecided);
  const double certain = 0.7 * radius;
  EXPECT_EQ(certify_passivity(valley(), {certain}, coarse).passivity, Passivity::certified);
  for (unsigned seed = 0; seed < 20; ++seed) {
    EXPECT_GE(lowest_sample(with_changed_numbers(valley(), 1e-3, seed), certain), 0);
  }
}

TEST(CertifyPassivity, CoversTheDigitsOfAStoredField) {
  const double tolerance = CertificateOptions{}.number_tolerance;
  for (unsigned seed = 0; seed < 30; ++seed) {
    ForceField field = mixed_field(6, seed);
    std::stable_partition(field.bases.begin(), field.bases.end(),
                          [](const auto& base) { return base.ridge.isZero(0); });
    const ForceField stored = rounded(field);
    for (std::size_t k = 0; k < field.bases.size(); ++k) {
      const Multiquadric &base = field.bases[k], &other = stored.bases[k];
      const double length = base.center.norm() + base.epsilon;
      EXPECT_NEAR(other.weight, base.weight, tolerance * std::abs(base.weight));
      EXPECT_NEAR(other.epsilon, base.epsilon, tolerance * base.epsilon);
      EXPECT_LE((other.ridge - base.ridge).norm(), tolerance);
      // The centre of a ridge may slide across it.
      const bool ridge = base.ridge.norm() > 0;
      const double moved =
          ridge ? std::abs(other.ridge.dot(other.center) - base.ridge.dot(base.center))
                : (other.center - base.center).norm();
      EXPECT_LE(moved, tolerance * length);
    }
  }
}

TEST(CertifyPassivity, DoesNotDependOnUnits) {
  const ForceField field = mixed_field(6, 3);
  const PassivityCertificate one = certify_passivity(field, {10});
  for (const double length : {0x1p-20, 0x1p20}) {
    for (const double newton : {0x1p-30, 0x1p30}) {
      ForceField scaled = field;
      for (Multiquadric& base : scaled.bases) {
        base.weight *= newton;
        base.epsilon *= length;
        base.center *= length;
      }
      const PassivityCertificate other = certify_passivity(scaled, {10 * length});
      EXPECT_EQ(other.passivity, one.passivity);
      EXPECT_EQ(other.cells, one.cells);
      EXPECT_EQ(other.weakest, length * one.weakest);
    }
  }
}

TEST(CertifyPassivity, FindsANegativeStiffnessAtZero) {
  // Curvature 1 - 3.06 / 3 < 0 at zero.
  const PassivityCertificate found = certify_passivity({{{1, 1}, {-3.06, 3}}}, {0.1});
  EXPECT_EQ(found.passivity, Passivity::violated);
  EXPECT_LT(found.weakest_stiffness, 0);
}

TEST(CertifyPassivity, LeavesDirectionsThatNothingResistsToTheEnergyTolerance) {
  // p = sqrt(x^2 + 1) - 1 >= 0, but not by its signs, and zero along y and z.
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), zero = Eigen::Vector3d::Zero();
  const ForceField field{{{2, 1, zero, x}, {-1, 1, zero, x}}};
  EXPECT_EQ(certify_passivity(field, {3}, {.max_cells = 3000}).passivity, Passivity::undecided);
  EXPECT_EQ(certify_passivity(field, {3}, {.energy_tolerance = 1e-3}).passivity,
            Passivity::certified);
}

TEST(CertifyPassivity, GivesUpAfterSoManyCells) {
  const PassivityCertificate found =
      certify_passivity(valley(), {0.99 * valley_radius()}, {.max_cells = 20});
  EXPECT_EQ(found.passivity, Passivity::undecided);
  EXPECT_EQ(found.cells, 20);
}

TEST(CertifyPassivity, IsNotConfusedByHugeNumbers) {
  const ForceField huge{{{1e300, 1e-300, {1e300, 0, 0}}, {-1e300, 1e100}}};
  EXPECT_EQ(certify_passivity(huge, {1e100}, {.max_cells = 500}).passivity, Passivity::undecided);
  EXPECT_EQ(certify_passivity(valley(), {0}).passivity, Passivity::certified);
}

TEST(CertifyPassivity, RefusesWhatItCannotUse) {
  EXPECT_THAT(refusal([&] { return certify_passivity({{{kNaN}}}, {1}); }), HasSubstr("base 0"));
  EXPECT_THAT(refusal([&] { return certify_passivity(valley(), {kNaN}); }), HasSubstr("radius"));
  EXPECT_THAT(refusal([&] { return certify_passivity(valley(), {-1}); }), HasSubstr("radius"));
  EXPECT_THAT(refusal([&] { return certify_passivity(valley(), {1}, {.number_tolerance = 1}); }),
              HasSubstr("number_tolerance is 1; it must be in [0, 0.001]"));
  EXPECT_THAT(refusal([&] { return certify_passivity(valley(), {1}, {.energy_tolerance = -1}); }),
              HasSubstr("energy_tolerance"));
  EXPECT_THAT(refusal([&] { return certify_passivity(valley(), {1}, {.max_cells = 0}); }),
              HasSubstr("max_cells"));
}

TEST(ReachableVolume, ReachesBeyondTheLongestDisplacement) {
  Eigen::Matrix3Xd displacements(3, 2);
  displacements << 1, 0, -2, 7, 2, 0;
  EXPECT_DOUBLE_EQ(reachable_volume(displacements).radius, kReachFactor * 7);
  EXPECT_EQ(reachable_volume(Eigen::Matrix3Xd(3, 0)).radius, 0);
}

}  // namespace
}  // namespace palpate::haptics
