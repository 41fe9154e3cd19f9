// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/transform_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::HasSubstr;

ForceField ridges() {
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

// [N] largest error of f'(A x) = factor A^-T f(x).
double error(const ForceField& before, const Matrix3d& A, double factor, const ForceField& after) {
  double largest = 0;
  const Eigen::Matrix3Xd displacements = random_points(300, 8);
  for (const auto& x : displacements.colwise()) {
    const Vector3d truth = factor * A.inverse().transpose() * force(before, x);
    largest = std::max(largest, (force(after, A * x) - truth).norm());
  }
  return largest;
}

TEST(TransformField, KeepsRidgesExactly) {
  const TransformedField result = transform_field(ridges(), some_map(), 1.7);
  EXPECT_TRUE(result.exact);
  EXPECT_EQ(result.field.bases.size(), 4u);
  EXPECT_LT(error(ridges(), some_map(), 1.7, result.field), 1e-12);
}

TEST(TransformField, IsExactForARotationAndAScale) {
  ForceField field = some_field();
  field.bases.push_back(ridges().bases[2]);
  const Matrix3d map = 2.3 * some_rotation();
  const TransformedField result = transform_field(field, map, 0.6);
  EXPECT_TRUE(result.exact);
  EXPECT_LT(error(field, map, 0.6, result.field), 1e-12);
}

TEST(TransformField, RefitsWhatBecomesAnEllipsoidAndSaysHowWell) {
  ForceField field = ridges();
  field.bases.push_back({.weight = 2.5, .epsilon = 4, .center = {1, -2, 3}});
  const Matrix3d map = Vector3d(1, 1, 1.6).asDiagonal();
  const TransformedField result = transform_field(field, map, 1.6);
  EXPECT_FALSE(result.exact);
  EXPECT_GT(result.reach, 7);
  const double off = error(field, map, 1.6, result.field);
  EXPECT_LT(off, 0.3);  // [N] of forces of up to 8 N
  EXPECT_GT(off, 1e-6);
  EXPECT_LT(result.rms, 0.1);
  EXPECT_LT(off, 3 * result.largest);
  const Eigen::Matrix3Xd displacements = random_points(300, 12);
  for (const auto& x : displacements.colwise()) EXPECT_GE(potential(result.field, x), 0);
}

TEST(TransformField, GoesBackToWhereItWas) {
  const ForceField there = transform_field(ridges(), some_map(), 1.7).field;
  const ForceField back = transform_field(there, some_map().inverse(), 1 / 1.7).field;
  EXPECT_LT(error(ridges(), Matrix3d::Identity(), 1, back), 1e-12);
  EXPECT_TRUE(transform_field({}, some_map(), 1).field.bases.empty());
}

TEST(TransformField, RefusesMapsAndFactorsWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([] { return transform_field(ridges(), Matrix3d::Zero(), 1); }),
              HasSubstr("volumes"));
  EXPECT_THAT(refusal([] { return transform_field(ridges(), -Matrix3d::Identity(), 1); }),
              HasSubstr("volumes"));
  EXPECT_THAT(refusal([&] { return transform_field(ridges(), Matrix3d::Constant(nan), 1); }),
              HasSubstr("volumes"));
  EXPECT_THAT(refusal([&] { return transform_field(ridges(), some_map(), nan); }),
              HasSubstr("factor"));
  ForceField bad = ridges();
  bad.bases[1].epsilon = 0;
  EXPECT_THAT(refusal([&] { return transform_field(bad, some_map(), 1); }), HasSubstr("base 1"));
}

}  // namespace
}  // namespace palpate::haptics
