// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/tip_contact.h"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::probing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const TipLaw kSticky{5, std::numeric_limits<double>::infinity(), 2, 3};
const TipLaw kSlippery{5, 0.3, 2, 3};
const Vector3d kInside(0.9, -0.4, 4.7), kStart(0.5, -0.1, 5.3);
const Vector3d kAnchor = Vector3d(0.3, -0.1, 5).normalized();

// The derivative of a traction by central differences.
template <typename Traction>
Matrix3d difference(const Traction& traction, const Vector3d& at) {
  constexpr double kStep = 1e-6;
  Matrix3d result;
  for (int k = 0; k < 3; ++k) {
    const Vector3d d = kStep * Vector3d::Unit(k);
    result.col(k) = (traction(at + d) - traction(at - d)) / (2 * kStep);
  }
  return result;
}

void expect_tangent(const TipLaw& law, const std::optional<Vector3d>& anchor, bool slips) {
  const auto contact = tip_traction(law, kInside, kStart, anchor);
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->slips, slips);
  const Matrix3d expected = difference(
      [&](const Vector3d& at) { return tip_traction(law, at, kStart, anchor)->traction; }, kInside);
  EXPECT_LT((contact->tangent - expected).norm(), 1e-7 * expected.norm());
}

TEST(TipContact, TangentIsTheDerivativeOfTheTraction) {
  expect_tangent(kSticky, kAnchor, false);
  expect_tangent(kSticky, std::nullopt, false);
  expect_tangent(kSlippery, kAnchor, true);
  expect_tangent(kSlippery, std::nullopt, true);
}

TEST(TipContact, APointThatBeganJustInsideSticksAsOneThatBeganJustOutside) {
  constexpr double kRounding = 1e-12;  // of the radius
  const Vector3d surface = 5 * Vector3d(0.3, -0.1, 5).normalized();
  const auto outside = tip_traction(kSticky, kInside, (1 + kRounding) * surface, std::nullopt);
  const Vector3d start = (1 - kRounding) * surface;
  const auto inside = tip_traction(kSticky, kInside, start, std::nullopt);
  EXPECT_LT((inside->traction - outside->traction).norm(), 1e-9 * outside->traction.norm());
  EXPECT_GT((inside->traction - 2 * (5 - kInside.norm()) * kInside.normalized()).norm(), 0.1);
  const Matrix3d expected = difference(
      [&](const Vector3d& at) { return tip_traction(kSticky, at, start, std::nullopt)->traction; },
      kInside);
  EXPECT_LT((inside->tangent - expected).norm(), 1e-7 * expected.norm());
}

TEST(TipContact, ASlippingPointIsOnTheConeAndStartsThereAgain) {
  const auto contact = tip_traction(kSlippery, kInside, kStart, kAnchor);
  const Vector3d n = kInside.normalized();
  const double pressure = contact->traction.dot(n);
  EXPECT_NEAR(pressure, 2 * (5 - kInside.norm()), 1e-12);
  EXPECT_NEAR((contact->traction - pressure * n).norm(), 0.3 * pressure, 1e-12);
  const auto again = tip_traction(kSlippery, kInside, kInside, contact->anchor);
  EXPECT_LT((again->traction - contact->traction).norm(), 1e-12);
}

TEST(TipContact, AStickingPointKeepsEnergy) {
  constexpr double kStep = 1e-6;
  const Matrix3d tangent = tip_traction(kSticky, kInside, kStart, kAnchor)->tangent;
  EXPECT_LT((tangent - tangent.transpose()).norm(), 1e-14 * tangent.norm());
  for (int k = 0; k < 3; ++k) {
    const Vector3d d = kStep * Vector3d::Unit(k);
    EXPECT_NEAR(-tip_traction(kSticky, kInside, kStart, kAnchor)->traction[k],
                (tip_traction(kSticky, kInside + d, kStart, kAnchor)->energy -
                 tip_traction(kSticky, kInside - d, kStart, kAnchor)->energy) /
                    (2 * kStep),
                1e-7);
  }
}

TEST(TipContact, NothingActsOutside) {
  EXPECT_FALSE(tip_traction(kSticky, kStart, kStart, kAnchor));
  EXPECT_FALSE(tip_traction(kSticky, Vector3d::Constant(std::nan("")), kStart, kAnchor));
}

TEST(TipContact, ABlockPushesPointsOutAlongItsDistance) {
  const RigidBlock block{{0, 0, 0}, {10, 8, 6}, 1.5};
  EXPECT_FALSE(obstacle_traction(block, 2, {5, 4, -0.1}));
  EXPECT_FALSE(obstacle_traction(block, 2, {0.1, 0.1, 0.1}));  // beyond the round corner
  // A face, an edge, a corner, and the middle.
  for (const Vector3d& at :
       {Vector3d(5, 4, 0.3), Vector3d(0.6, 4, 0.7), Vector3d(0.9, 1, 1.1), Vector3d(5, 4, 2.5)}) {
    const auto pushed = obstacle_traction(block, 2, at);
    ASSERT_TRUE(pushed);
    const Matrix3d expected =
        difference([&](const Vector3d& p) { return obstacle_traction(block, 2, p)->traction; }, at);
    EXPECT_LT((pushed->tangent - expected).norm(), 1e-7 * expected.norm());
    EXPECT_LT(pushed->traction.z(), 1e-12);
  }
  EXPECT_NEAR(obstacle_traction(block, 2, {5, 4, 0.3})->traction.z(), -2 * 0.3, 1e-12);
}

}  // namespace
}  // namespace palpate::probing
