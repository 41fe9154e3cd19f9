// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/transform_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "haptics_testing.h"
#include "palpate/haptics/passivity_certificate.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

ForceField some_ridges() {
  ForceField field;
  for (int i = 0; i < 4; ++i) {
    const double k = i;
    field.bases.push_back({.weight = 1 + 0.3 * k,
                           .epsilon = 2 + 0.7 * k,
                           .center = Vector3d(0.4 * k, 1.1, -2 + k),
                           .ridge = Vector3d(1 - k, 0.3 * k, 2.1).normalized()});
  }
  return field;
}

Matrix3d some_map() {
  Matrix3d map;
  map << 1.3, 0.2, -0.1, 0.3, 0.7, 0.2, -0.2, 0.1, 2.1;
  return map;
}

// [N] largest error of f'(A x) = factor A^-T f(x) at displacements x of up to `reach`.
double error(const ForceField& before, const Matrix3d& A, double factor, const ForceField& after,
             double reach = 8) {
  double largest = 0;
  const Eigen::Matrix3Xd displacements = random_points(300, reach);
  for (const auto& x : displacements.colwise()) {
    const Vector3d truth = factor * A.inverse().transpose() * force(before, x);
    largest = std::max(largest, (force(after, A * x) - truth).norm());
  }
  return largest;
}

TEST(TransformField, KeepsRidgesExactly) {
  const TransformedField result = transform_field(some_ridges(), some_map(), 1.7);
  EXPECT_TRUE(result.exact);
  EXPECT_EQ(result.field.bases.size(), 4u);
  EXPECT_LT(error(some_ridges(), some_map(), 1.7, result.field), 1e-12);
}

TEST(TransformField, IsExactForARotationAndAScale) {
  ForceField field = some_field();
  field.bases.push_back(some_ridges().bases[2]);
  const Matrix3d map = 2.3 * some_rotation();
  const TransformedField result = transform_field(field, map, 0.6);
  EXPECT_TRUE(result.exact);
  EXPECT_LT(error(field, map, 0.6, result.field), 1e-12);
}

// Isotropic bases of a fit: one as large as the displacements, the others far beyond them.
ForceField far_field() {
  ForceField field = some_ridges();
  field.bases.push_back({.weight = 2.5, .epsilon = 4, .center = {1, -2, 3}});
  field.bases.push_back({.weight = 90, .epsilon = 60, .center = {-80, 100, 40}});
  field.bases.push_back({.weight = 40, .epsilon = 25, .center = {10, 120, -90}});
  return field;
}

// [N] root mean square of the force at a distance.
double mean_force(const ForceField& field, double radius) {
  double sum = 0;
  const Eigen::Matrix3Xd points = random_points(2000, 1, 5);
  for (const auto& x : points.colwise())
    sum += force(field, radius * x.normalized()).squaredNorm() / 2000;
  return std::sqrt(sum);
}

TEST(TransformField, RefitsWhatBecomesAnEllipsoidAndSaysHowWell) {
  ForceField field = some_ridges();
  field.bases.push_back({.weight = 2.5, .epsilon = 4, .center = {1, -2, 3}});
  const Matrix3d map = Vector3d(1, 1, 1.6).asDiagonal();
  const TransformedField result = transform_field(field, map, 1.6, 4);
  EXPECT_FALSE(result.exact);
  const double off = error(field, map, 1.6, result.field, result.reach);
  EXPECT_LT(off, 0.02 * mean_force(field, result.reach));
  EXPECT_GT(off, 1e-6);
  EXPECT_LT(result.rms, 0.05);
  EXPECT_GE(result.largest, result.rms);
  EXPECT_LT(off, 3 * result.largest);
}

TEST(TransformField, RefitsAsFarAsTheObjectIsPressed) {
  const Matrix3d map = Vector3d(1, 0.7, 1.6).asDiagonal();
  double before = 0;
  for (const double pressed : {1.0, 4.0}) {
    const TransformedField result = transform_field(far_field(), map, 1, pressed);
    EXPECT_NEAR(mean_force(far_field(), result.reach / kReachFactor), pressed, 0.03 * pressed);
    EXPECT_GT(result.reach, before);
    EXPECT_LT(error(far_field(), map, 1, result.field, result.reach), 0.03 * pressed);
    before = result.reach;
  }
  // No displacement reaches this force: the reach ends where the force hardly grows any more.
  const TransformedField soft = transform_field(spring(2, 5), map, 1, 1e6);
  EXPECT_NEAR(mean_force(spring(2, 5), soft.reach / kReachFactor), 0.75 * 2, 0.01);
  EXPECT_EQ(transform_field(spring(2, 5), map, 1).reach, 5);
}

TEST(TransformField, StaysConvex) {
  const Matrix3d map = some_map();
  const TransformedField result = transform_field(far_field(), map, 1.7, 4);
  for (const Multiquadric& base : result.field.bases) EXPECT_GE(base.weight, 0);
  const PassivityCertificate certificate = certify_passivity(result.field, {1e4});
  EXPECT_EQ(certificate.passivity, Passivity::convex);
  // In other units of length and force it is the same.
  const TransformedField metres =
      transform_field(scaled(far_field(), 1e3, 1e-3), map, 1.7 * 1e-6, 4e3);
  EXPECT_NEAR(metres.reach, 1e-3 * result.reach, 1e-9 * result.reach);
}

TEST(TransformField, IsPassiveWithANegativeWeight) {
  const Matrix3d map = Vector3d(1, 1, 1.6).asDiagonal();
  const ForceField field = some_field_with_ridge();
  const TransformedField result = transform_field(field, map, 1.6, 3);
  EXPECT_FALSE(result.exact);
  EXPECT_TRUE(is_passive(certify_passivity(result.field, {result.reach})));
  EXPECT_LT(error(field, map, 1.6, result.field, result.reach), 3 * result.largest);
  EXPECT_LT(result.rms, 0.05 * mean_force(field, result.reach));
}

TEST(TransformField, RefitsInShortNumbers) {
  const Matrix3d map = Vector3d(1, 1, 1.6).asDiagonal();
  for (const ForceField& field : {spring(2, 5), some_field()}) {
    const TransformedField result = transform_field(field, map, 1.6, 1);
    EXPECT_GT(result.rms, 0);
    EXPECT_EQ(result.field, rounded(result.field));
  }
}

TEST(TransformField, GoesBackToWhereItWas) {
  const ForceField there = transform_field(some_ridges(), some_map(), 1.7).field;
  const ForceField back = transform_field(there, some_map().inverse(), 1 / 1.7).field;
  EXPECT_LT(error(some_ridges(), Matrix3d::Identity(), 1, back), 1e-12);
  EXPECT_TRUE(transform_field({}, some_map(), 1).field.bases.empty());
}

TEST(TransformField, RefusesMapsAndFactorsWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([] { return transform_field(some_ridges(), Matrix3d::Zero(), 1); }),
              HasSubstr("volumes"));
  EXPECT_THAT(refusal([] { return transform_field(some_ridges(), -Matrix3d::Identity(), 1); }),
              HasSubstr("volumes"));
  EXPECT_THAT(refusal([&] { return transform_field(some_ridges(), Matrix3d::Constant(nan), 1); }),
              HasSubstr("volumes"));
  EXPECT_THAT(refusal([&] { return transform_field(some_ridges(), some_map(), nan); }),
              HasSubstr("factor"));
  for (const double force : {0.0, -1.0, nan}) {
    EXPECT_THAT(refusal([&] { return transform_field(spring(1, 1), some_map(), 1, force); }),
                HasSubstr("largest_force"));
  }
  ForceField bad = some_ridges();
  bad.bases[1].epsilon = 0;
  EXPECT_THAT(refusal([&] { return transform_field(bad, some_map(), 1); }), HasSubstr("base 1"));
}

}  // namespace
}  // namespace palpate::haptics
