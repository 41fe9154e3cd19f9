// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/field_warp.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>

#include "haptics_testing.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

constexpr double kWarpTolerance = 1e-10;  // tens of operations on values of order 1 to 100

Compliance compliance(double x, double y, double z, double xx, double xy, double yy) {
  return (Compliance() << x, y, z, xx, xy, yy).finished();
}

Eigen::Matrix2d across(const Compliance& values) {
  return (Eigen::Matrix2d() << values(3), values(4), values(4), values(5)).finished();
}

const Compliance kSoft = compliance(2.1, -0.7, 17, 1.2, -0.3, 5.1);
const Compliance kStiff = compliance(-3.2, 0.4, 7.3, 0.8, 0.2, 2.2);

TEST(WarpBetween, IsTheIdentityBetweenEqualCompliances) {
  const FieldWarp warp = warp_between(kSoft, kSoft);
  EXPECT_LT((warp.displacement - Eigen::Matrix3d::Identity()).norm(), kWarpTolerance);
  EXPECT_EQ(warp.energy, 1);
}

TEST(WarpBetween, KeepsTheForceAtTheDisplacementAndGivesTheStiffnessAcross) {
  const FieldWarp warp = warp_between(kSoft, kStiff);
  EXPECT_LT((warp.displacement * kStiff.head<3>() - kSoft.head<3>()).norm(), kWarpTolerance);
  const Eigen::Vector3d force(0, 0, 3);
  EXPECT_LT((warp.energy * warp.displacement.transpose() * force - force).norm(), kWarpTolerance);
  // Any stiffness of the field whose block across is that of kSoft.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Constant(0.2);
  stiffness.topLeftCorner<2, 2>() = across(kSoft).inverse();
  const Eigen::Matrix3d warped =
      warp.energy * warp.displacement.transpose() * stiffness * warp.displacement;
  const Eigen::Matrix2d product = warped.topLeftCorner<2, 2>() * across(kStiff);
  EXPECT_LT((product - Eigen::Matrix2d::Identity()).norm(), kWarpTolerance);
}

TEST(WarpBetween, TurnsWithTheAxes) {
  const Eigen::Matrix3d turn = rotation_exp({0, 0, 0.7});
  const Eigen::Matrix2d plane = turn.topLeftCorner<2, 2>();
  const Eigen::Matrix3d expected =
      turn * warp_between(kSoft, kStiff).displacement * turn.transpose();
  const FieldWarp warp = warp_between(turned(kSoft, plane), turned(kStiff, plane));
  EXPECT_LT((warp.displacement - expected).norm(), kWarpTolerance);
}

TEST(Turned, ByAQuarterExchangesTheAxes) {
  const Eigen::Matrix2d quarter{{0, -1}, {1, 0}};
  EXPECT_LT((turned(kSoft, quarter) - compliance(0.7, 2.1, 17, 5.1, 0.3, 1.2)).norm(),
            kWarpTolerance);
}

TEST(TurnBetween, LeavesOnlyWhatTheXAxesDifferByAfterTheSmallestTurnOfZ) {
  const Eigen::Matrix3d from = rotation_exp({0.4, -0.3, 0.9});
  // Tilted about an axis across z, then turned about the new z.
  const Eigen::Matrix3d to = from * rotation_exp({0.5, 0.2, 0}) * rotation_exp({0, 0, 0.6});
  const Eigen::Matrix2d expected = rotation_exp({0, 0, -0.6}).topLeftCorner<2, 2>();
  EXPECT_LT((turn_between(from, to) - expected).norm(), kWarpTolerance);
}

// Three contacts in a plane whose compliances and trends are those of a cubic function of the
// place.
class CubicCompliance : public ::testing::Test {
 protected:
  static double cubic(const Eigen::Vector2d& p) {
    const double x = p.x(), y = p.y();
    return 50 + 0.3 * x - 0.2 * y + 0.02 * x * x - 0.01 * x * y + 0.015 * y * y + 4e-4 * x * x * x -
           2e-4 * x * x * y + 3e-4 * x * y * y - 1e-4 * y * y * y;
  }
  static Eigen::RowVector<double, 5> derivatives(const Eigen::Vector2d& p) {
    const double x = p.x(), y = p.y();
    return {0.3 + 0.04 * x - 0.01 * y + 12e-4 * x * x - 4e-4 * x * y + 3e-4 * y * y,
            -0.2 - 0.01 * x + 0.03 * y - 2e-4 * x * x + 6e-4 * x * y - 3e-4 * y * y,
            0.04 + 24e-4 * x - 4e-4 * y, -0.01 - 4e-4 * x + 6e-4 * y, 0.03 + 6e-4 * x - 6e-4 * y};
  }
  CubicCompliance() : contacts(3), frames(3, Eigen::Matrix3d::Identity()) {
    const std::array<Eigen::Vector2d, 3> places{{{-8, -5}, {9, -3}, {1, 11}}};
    for (std::size_t k = 0; k < 3; ++k) {
      contacts[k].position << places[k], 700;
      ContactCompliance& given = contacts[k].compliance.emplace();
      given.values << 0, 0, cubic(places[k]), 1, 0, 1;
      given.trend.row(2) = derivatives(places[k]);
      contacts[k].strength = {.value = cubic(places[k]), .trend = derivatives(places[k])};
    }
  }
  [[nodiscard]] double at(const std::array<double, 3>& weights, const Eigen::Vector3d& place,
                          double reach = 100) const {
    return compliance_between(contacts, frames, indices, weights, place,
                              Eigen::Matrix3d::Identity(), reach)(2);
  }
  [[nodiscard]] Eigen::Vector3d place(const std::array<double, 3>& weights) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) sum += weights[k] * contacts[k].position;
    return sum;
  }
  std::vector<ContactModel> contacts;
  std::vector<Eigen::Matrix3d> frames;
  std::array<int, 3> indices{0, 1, 2};
};

TEST_F(CubicCompliance, IsReproducedBetweenTheContacts) {
  for (const std::array<double, 3>& weights :
       {std::array{1.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, {0.2, 0.3, 0.5}, {0.1, 0.8, 0.1}}) {
    const Eigen::Vector3d where = place(weights);
    EXPECT_NEAR(at(weights, where), cubic(where.head<2>()), kWarpTolerance);
  }
}

TEST_F(CubicCompliance, IsFollowedBeyondTheContactsAsFarAsTheReach) {
  const Eigen::Vector2d there = contacts[1].position.head<2>() + Eigen::Vector2d(4, 0);
  const Eigen::RowVector<double, 5> d = derivatives(contacts[1].position.head<2>());
  const double value = contacts[1].compliance->values(2);
  const Eigen::Vector3d outside(there.x(), there.y(), 700);
  EXPECT_NEAR(at({0, 1, 0}, outside), value + 4 * d(0) + 8 * d(2), kWarpTolerance);
  EXPECT_NEAR(at({0, 1, 0}, outside, 1), value + d(0) + d(2) / 2, kWarpTolerance);
}

TEST_F(CubicCompliance, IsReproducedAsAStrengthThatScalesTheMeanOfTheContacts) {
  for (const std::array<double, 3>& weights :
       {std::array{1.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, {0.2, 0.3, 0.5}, {0.1, 0.8, 0.1}}) {
    const Eigen::Vector3d where = place(weights);
    double mean = 0;
    for (std::size_t k = 0; k < 3; ++k) mean += weights[k] * contacts[k].strength->value;
    EXPECT_NEAR(mean * strength_factor(contacts, indices, weights, where, 100),
                cubic(where.head<2>()), kWarpTolerance);
  }
}

TEST(StrengthFactor, IsOneWithoutStrengthsAndLimitedOtherwise) {
  const std::array<double, 3> weights{0.2, 0.3, 0.5};
  std::vector<ContactModel> contacts(3);
  const std::array<int, 3> indices{0, 1, 2};
  const auto factor = [&] {
    return strength_factor(contacts, indices, weights, Eigen::Vector3d(1, 2, 3), 100);
  };
  EXPECT_EQ(factor(), 1);
  for (ContactModel& contact : contacts)
    contact.strength = {.value = 0, .trend = Eigen::Vector<double, 5>::Ones()};
  EXPECT_EQ(factor(), 1);
  for (ContactModel& contact : contacts) contact.strength->value = 1e-9;
  EXPECT_EQ(factor(), 1 + kMaxChange);
}

TEST_F(CubicCompliance, NeverChangesTheMeanByMoreThanItsPart) {
  contacts[1].compliance->trend *= -1e6;
  const Eigen::Vector3d outside = contacts[1].position + Eigen::Vector3d(4, 0, 0);
  const double value = contacts[1].compliance->values(2);
  EXPECT_NEAR(at({0, 1, 0}, outside), (1 - kMaxChange) * value, 1e-9 * value);
  contacts[1].compliance->trend.row(3).setConstant(-1e9);
  const Compliance found = compliance_between(contacts, frames, indices, std::array{0.0, 1.0, 0.0},
                                              outside, Eigen::Matrix3d::Identity(), 100);
  EXPECT_GE(across(found).eigenvalues().real().minCoeff(), (1 - kMaxChange) * (1 - kWarpTolerance));
}

TEST_F(CubicCompliance, LeavesOutContactsWithoutCompliance) {
  const std::array<double, 3> weights{0.4, 0.6, 0};
  const double expected = at(weights, place(weights));
  contacts[2].compliance.reset();
  EXPECT_NEAR(at({0.2, 0.3, 0.5}, place(weights)), expected, kWarpTolerance);
}

}  // namespace
}  // namespace palpate::haptics
