// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/contact_compliance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "palpate/haptics/blended_field.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

// Ridges along three axes: f = w x / sqrt(x^2 + e^2) along each, stiffness w / e at zero.
ForceField ridges_along_axes(const Eigen::Vector3d& weights, const Eigen::Vector3d& epsilons) {
  ForceField field;
  for (int axis = 0; axis < 3; ++axis) {
    field.bases.push_back(
        {weights(axis), epsilons(axis), Eigen::Vector3d::Zero(), Eigen::Vector3d::Unit(axis)});
  }
  return field;
}

// Compliance over that at the origin of an object held at x = +-60, as a stretched sheet.
double softness(double x) { return 1 - x * x / 3600; }

// Contacts 14 mm apart on the flat surface, all fields of one shape: displacements for the same
// force go with softness(x).
Model stretched_model(double spacing = 14) {
  return grid_model(spacing, [](double x, double) {
    return ridges_along_axes({9, 12, 6}, softness(x) * Eigen::Vector3d(5, 14, 20));
  });
}

Eigen::Vector3d true_force(double x, const Eigen::Vector3d& displacement) {
  return force(ridges_along_axes({9, 12, 6}, softness(x) * Eigen::Vector3d(5, 14, 20)),
               displacement);
}

double worst_error(const Model& model) {
  const BlendedField field(model);
  double worst = 0;
  for (double x = -40; x <= 40; x += 3.1) {
    for (const Eigen::Vector3d& direction :
         {Eigen::Vector3d(0, 0, 12), Eigen::Vector3d(2, 0, 10), Eigen::Vector3d(-1, 4, 9)}) {
      const Eigen::Vector3d displacement = softness(x) * direction;
      const Eigen::Vector3d found = field.force({x, 0.2 * x + 1, 700}, displacement);
      worst = std::max(worst, (found - true_force(x, displacement)).norm());
    }
  }
  return worst;
}

TEST(WithCompliances, FindsDisplacementAndStiffnessUnderTheReferenceForce) {
  const Model model = with_compliances(stretched_model(), 3);
  EXPECT_EQ(model.interpolation.rule, BlendRule::compliances);
  EXPECT_EQ(model.interpolation.reference_force, 3);
  EXPECT_NEAR(model.interpolation.reach, 28, 1e-9);
  for (const ContactModel& contact : model.contacts) {
    ASSERT_TRUE(contact.compliance);
    const double soft = softness(contact.position.x());
    const Eigen::Vector<double, 6>& values = contact.compliance->values;
    // 3 = 6 z / sqrt(z^2 + e^2)
    EXPECT_NEAR(values(2), 20 * soft / std::sqrt(3), 1e-5);
    EXPECT_NEAR(values(3), 5 * soft / 9, 1e-6);
    EXPECT_NEAR(values(5), 14 * soft / 12, 1e-6);
    EXPECT_NEAR(values.head<2>().norm() + std::abs(values(4)), 0, 1e-6);
  }
}

TEST(WithCompliances, FindsTheTrendAlongTheSurface) {
  const Model model = with_compliances(stretched_model(), 3);
  for (const ContactModel& contact : model.contacts) {
    if (contact.position.head<2>().cwiseAbs().maxCoeff() > 30) continue;
    const double top = 20 / std::sqrt(3);
    const auto trend = contact.compliance->trend.row(2);
    // An estimate from contacts 14 mm apart: an error of 0.03 is 3 % of u_z half way between them.
    EXPECT_NEAR(trend(0), -2 * contact.position.x() / 3600 * top, 0.03);
    EXPECT_NEAR(trend(1), 0, 1e-3);
    EXPECT_NEAR(trend(2), -2.0 / 3600 * top, 1.4 * top / 3600);
  }
  // The missing part is what kriging cannot tell from noise: it decreases with the spacing.
  for (const ContactModel& contact : with_compliances(stretched_model(7), 3).contacts) {
    if (contact.position.head<2>().cwiseAbs().maxCoeff() > 30) continue;
    const double top = 20 / std::sqrt(3);
    const auto trend = contact.compliance->trend.row(2);
    EXPECT_NEAR(trend(0), -2 * contact.position.x() / 3600 * top, 0.01);
    EXPECT_NEAR(trend(1), 0, 1e-3);
    EXPECT_NEAR(trend(2), -2.0 / 3600 * top, 0.5 * top / 3600);
  }
}

TEST(WithCompliances, PredictsASheetFarBetterThanForcesAtTheSameDisplacement) {
  const Model model = stretched_model();
  const double by_forces = worst_error(model);
  const double by_compliances = worst_error(with_compliances(model, 3));
  EXPECT_LT(by_compliances, 0.5 * by_forces);
  EXPECT_GT(by_forces, 0.2);
  // All fields have one shape, so the error is that of the trends alone, and of second order at
  // least in the spacing; that of forces goes with the spacing.
  EXPECT_LT(worst_error(with_compliances(stretched_model(7), 3)), 0.4 * by_compliances);
  EXPECT_GT(worst_error(stretched_model(7)), 0.4 * by_forces);
}

TEST(WithCompliances, KeepsEachContactsFieldAtItsPlaceAndDoesNotJumpBetween) {
  const Model model = with_compliances(stretched_model(), 3);
  const BlendedField field(model);
  const Eigen::Vector3d displacement(1.1, -0.7, 8);
  for (const ContactModel& contact : model.contacts) {
    const Eigen::Vector3d expected =
        contact.frame * force(contact.field, contact.frame.transpose() * displacement);
    EXPECT_LT((field.force(contact.position, displacement) - expected).norm(), 1e-9);
  }
  // Along a line across many triangles, and over the outermost contacts.
  Eigen::Vector3d before = field.force({-50, -33, 700}, displacement);
  const double step = 1e-3;
  for (double t = -50; t <= 50; t += step) {
    const Eigen::Vector3d now = field.force({t, 0.66 * t, 700}, displacement);
    EXPECT_LT((now - before).norm(), 2 * step) << t;
    before = now;
  }
}

TEST(WithCompliances, StaysPassiveAndIsTheGradientOfAnEnergy) {
  const Model model = with_compliances(stretched_model(28), 3);
  const BlendedField field(model);
  const Eigen::Matrix3Xd places = random_points(30, 40), displacements = random_points(30, 15);
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const Blend at = field.blend(Eigen::Vector3d(places(0, i), places(1, i), 700));
    const Eigen::Vector3d x = displacements.col(i);
    // Monotone: the gradient of a convex function, least at zero.
    const Eigen::Vector3d y = displacements.col((i + 1) % displacements.cols());
    EXPECT_GE((field.force(at, x) - field.force(at, y)).dot(x - y), -1e-12);
    EXPECT_GE(field.force(at, x).dot(x), 0);
    Eigen::Matrix3d derivative;
    const double step = 1e-4;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d along = step * Eigen::Vector3d::Unit(axis);
      derivative.col(axis) = (field.force(at, x + along) - field.force(at, x - along)) / (2 * step);
    }
    EXPECT_LT((derivative - derivative.transpose()).norm(), 1e-6 * (1 + derivative.norm()));
  }
}

TEST(WithCompliances, MovesWithTheWorldAndDoesNotDependOnATurnOfTheLocalAxes) {
  const Model model = stretched_model();
  const BlendedField field(with_compliances(model, 3));
  const Eigen::Isometry3d motion = some_motion();
  Model other = moved(model, motion);
  const Eigen::Matrix3d turn = rotation_exp({0, 0, 0.6});
  for (ContactModel& contact : other.contacts) {
    contact.frame = contact.frame * turn;
    contact.field = rotated(std::move(contact.field), turn.transpose());
  }
  const BlendedField elsewhere(with_compliances(other, 3));
  const Eigen::Vector3d displacement(1, -2, 9);
  const Eigen::Matrix3Xd places = random_points(20, 40);
  for (const auto& at : places.colwise()) {
    const Eigen::Vector3d place(at.x(), at.y(), 700);
    const Eigen::Vector3d expected = motion.linear() * field.force(place, displacement);
    const Eigen::Vector3d found = elsewhere.force(motion * place, motion.linear() * displacement);
    EXPECT_LT((found - expected).norm(), 1e-3);
  }
}

TEST(WithCompliances, FollowsTheSurfaceNotTheFriction) {
  Model model = stretched_model();
  const BlendedField straight(with_compliances(model, 3));
  // Friction tilts the frames differently at each contact; the fields in the world are the same.
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    ContactModel& contact = model.contacts[i];
    const Eigen::Matrix3d tilt = rotation_exp(
        {0.1 * std::sin(static_cast<double>(i)), 0.1 * std::cos(2.0 * static_cast<double>(i)), 0});
    contact.frame = tilt;
    contact.field = rotated(std::move(contact.field), tilt.transpose());
  }
  const BlendedField tilted(with_compliances(model, 3));
  const Eigen::Vector3d displacement(1, -2, 9);
  const Eigen::Matrix3Xd places = random_points(20, 40);
  for (const auto& at : places.colwise()) {
    const Eigen::Vector3d place(at.x(), at.y(), 700);
    EXPECT_LT((tilted.force(place, displacement) - straight.force(place, displacement)).norm(),
              0.01);
  }
}

TEST(WithCompliances, LeavesContactsAsTheyAreThatDoNotReachTheForce) {
  Model model = stretched_model(42);
  model.contacts[4].field = {};
  model.contacts[2].field = ridges_along_axes({2, 2, 2}, {10, 10, 10});  // bounded by 2 N
  const Model found = with_compliances(model, 3);
  EXPECT_FALSE(found.contacts[4].compliance);
  EXPECT_FALSE(found.contacts[2].compliance);
  EXPECT_TRUE(found.contacts[0].compliance);
  const BlendedField field(found);
  EXPECT_TRUE(field.force({1, 2, 700}, {1, 1, 8}).allFinite());
  EXPECT_EQ(field.force(found.contacts[4].position, {1, 1, 8}), Eigen::Vector3d::Zero());
  for (ContactModel& contact : model.contacts) contact.field = {};
  EXPECT_EQ(BlendedField(with_compliances(model, 3)).force({1, 2, 700}, {1, 1, 8}),
            Eigen::Vector3d::Zero());
}

TEST(WithCompliances, RefusesAForceThatIsNotPositive) {
  for (const double wrong : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THAT(refusal([&] { return with_compliances(stretched_model(42), wrong); }),
                HasSubstr("reference_force is"));
  }
}

}  // namespace
}  // namespace palpate::haptics
