// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/blended_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "palpate/haptics/contact_compliance.h"
#include "sheet_model.h"
#include "sphere_model.h"

namespace palpate::haptics {
namespace {

constexpr double kBlendTolerance = 1e-12;  // a hundred operations on values of order 1 to 1000
const Eigen::Vector3d kPush(1.1, -0.7, 2.3);

TEST(BlendedField, AtAContactIsItsOwnField) {
  const Model model = uneven_model();
  const BlendedField field(model);
  for (const ContactModel& contact : model.contacts) {
    const Eigen::Vector3d expected =
        contact.frame * force(contact.field, contact.frame.transpose() * kPush);
    EXPECT_LT((field.force(contact.position, kPush) - expected).norm(), kBlendTolerance);
    EXPECT_NEAR(field.blend(contact.position).friction, contact.friction, kBlendTolerance);
    EXPECT_LT((field.blend(contact.position).friction_axis - contact.friction_axis).norm(),
              kBlendTolerance);
  }
}

TEST(BlendedField, BlendsLinearlyBetweenContactsInTheBlendedFrame) {
  Model model = uneven_model();
  for (ContactModel& contact : model.contacts) contact.frame = some_rotation();
  const BlendedField field(model);
  // On the edge from contact 0 to contact 1, three tenths of the way.
  const Eigen::Vector3d place = 0.7 * model.contacts[0].position + 0.3 * model.contacts[1].position;
  const Eigen::Vector3d local = some_rotation().transpose() * kPush;
  const Eigen::Vector3d expected = some_rotation() * (0.7 * force(model.contacts[0].field, local) +
                                                      0.3 * force(model.contacts[1].field, local));
  EXPECT_LT((field.force(place, kPush) - expected).norm(), kBlendTolerance);
  EXPECT_NEAR(field.blend(place).friction, 0.7 * 0.4 + 0.3 * 0.5, kBlendTolerance);
}

TEST(BlendedField, TakesTheWeightsOfTheSurfaceWhereThereAreSome) {
  Model model = uneven_model();
  model.surface_weights = geometry::project_weights(model.surface, contact_mesh(model));
  const geometry::SurfacePoint place{.triangle = 40, .barycentric = {0.2, 0.3, 0.5}};
  const BlendedField projected(model);
  // Contact 2 alone around the place: its field, and no triangles are needed.
  for (const int corner : model.surface.triangles.col(place.triangle)) {
    model.surface_weights.contacts.col(corner) << 2, -1, -1;
    model.surface_weights.weights.col(corner) << 1, 0, 0;
  }
  model.triangles.resize(3, 0);
  const BlendedField field(model);
  const ContactModel& contact = model.contacts[2];
  const Eigen::Vector3d expected =
      contact.frame * force(contact.field, contact.frame.transpose() * kPush);
  EXPECT_LT((field.force(field.blend(place), kPush) - expected).norm(), kBlendTolerance);
  EXPECT_GT((projected.force(projected.blend(place), kPush) - expected).norm(), 1e-3);
}

TEST(BlendedField, IsZeroAtZeroDisplacementAndContinuousAcrossTriangles) {
  const BlendedField field(uneven_model());
  EXPECT_EQ(field.force({3, 4, 700}, Eigen::Vector3d::Zero()), Eigen::Vector3d::Zero());
  // The diagonal between the two triangles runs through (x, -x).
  const double step = 1e-7;
  const Eigen::Vector3d below = field.force({10 - step, -10 - step, 700}, kPush);
  const Eigen::Vector3d above = field.force({10 + step, -10 + step, 700}, kPush);
  EXPECT_LT((above - below).norm(), 1e-6);
  EXPECT_GT((above - below).norm(), 0);
}

TEST(BlendedField, MovesWithTheWorld) {
  const Eigen::Isometry3d motion = some_motion();
  const BlendedField field(uneven_model()), elsewhere(moved(uneven_model(), motion));
  const Eigen::Matrix3Xd places = random_points(30, 40);
  for (const auto& offset : places.colwise()) {
    const Eigen::Vector3d place(offset.x(), offset.y(), 700);
    const Eigen::Vector3d expected = motion.linear() * field.force(place, kPush);
    EXPECT_LT((elsewhere.force(motion * place, motion.linear() * kPush) - expected).norm(), 1e-9);
  }
}

TEST(BlendedField, DoesNotDependOnACommonTurnOfTheLocalAxes) {
  Model model = uneven_model();
  const BlendedField field(model);
  for (ContactModel& contact : model.contacts) {
    contact.frame = contact.frame * some_rotation();
    contact.field = rotated(contact.field, some_rotation().transpose());
  }
  const BlendedField turned(model);
  EXPECT_LT((turned.force({7, 11, 700}, kPush) - field.force({7, 11, 700}, kPush)).norm(),
            kBlendTolerance);
}

// A ball that is felt all round, at each contact stiffer in one direction along it, with the x axis
// of contact i turned by `twist(i)`.
Model grained_ball(int contacts, const std::function<double(int)>& twist) {
  Model model =
      ball_model([](const Eigen::Vector3d&) { return true; }, [](int) { return 0.0; }, contacts);
  for (ContactModel& contact : model.contacts) {
    contact.field.bases.push_back(
        {.weight = 2, .epsilon = 5, .ridge = Eigen::Vector3d(1, 2, 0).normalized()});
    const Eigen::Matrix3d turn = rotation_exp({0, 0, twist(static_cast<int>(contact.id))});
    contact.frame = contact.frame * turn;
    contact.field = rotated(contact.field, turn.transpose());
  }
  return with_compliances(std::move(model), 2);
}

TEST(BlendedField, ByComplianceDoesNotDependOnTheXAxesOfContacts) {
  const BlendedField field(grained_ball(30, [](int) { return 0.0; }));
  const BlendedField turned(grained_ball(30, [](int i) { return 2.3 * i; }));
  for (const Eigen::Vector3d& place : places_on_sphere(500)) {
    const Eigen::Vector3d difference = turned.force(place, kPush) - field.force(place, kPush);
    EXPECT_LT(difference.norm(), 1e-3);  // [N] of 3 N: trends have five digits
  }
}

TEST(BlendedField, ByComplianceDoesNotJumpAnywhereOnAClosedSurface) {
  for (const int contacts : {12, 30}) {
    const BlendedField field(grained_ball(contacts, [](int i) { return 2.3 * i; }));
    const auto largest_step = [&](const Eigen::Matrix3d& circle, int steps) {
      double largest = 0;
      Eigen::Vector3d before = field.force(kSphereRadius * circle.col(0), kPush);
      for (int i = 1; i <= steps; ++i) {
        const double angle = 2 * std::numbers::pi * i / steps;
        const Eigen::Vector3d place =
            kSphereRadius * (std::cos(angle) * circle.col(0) + std::sin(angle) * circle.col(1));
        const Eigen::Vector3d now = field.force(place, kPush);
        largest = std::max(largest, (now - before).norm());
        before = now;
      }
      return largest;
    };
    for (int i = 0; i < 6; ++i) {
      const Eigen::Matrix3d circle = rotation_exp(Eigen::Vector3d(0.3, 1.1, -0.4) * i);
      // A quarter, but a jump would stay.
      EXPECT_LT(largest_step(circle, 16000), 0.4 * largest_step(circle, 4000))
          << contacts << " contacts, circle " << i;
    }
  }
}

TEST(BlendedField, HasTheDerivativeOfTheForceAsItsStiffness) {
  for (const Model& model : {uneven_model(), with_compliances(uneven_model(), 1)}) {
    const BlendedField field(model);
    const Blend at = field.blend(Eigen::Vector3d(7, -4, 700));
    Eigen::Matrix3d differences;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = kDifferenceStep * Eigen::Vector3d::Unit(axis);
      differences.col(axis) =
          (field.force(at, kPush + step) - field.force(at, kPush - step)) / (2 * kDifferenceStep);
    }
    EXPECT_LT((field.stiffness(at, kPush) - differences).norm(), kDifferenceTolerance);
  }
}

TEST(BlendedField, StatesTheErrorsOfAContactAtIt) {
  Model model = with_compliances(uneven_model(), 1);
  EXPECT_EQ(BlendedField(model).deviation(model.contacts[1].position, kPush), std::nullopt);
  const auto stated = [&](const ContactUncertainty& uncertainty) {
    for (ContactModel& contact : model.contacts) contact.uncertainty = uncertainty;
    return BlendedField(model).deviation(model.contacts[1].position, kPush).value();
  };
  const ContactModel& contact = model.contacts[1];
  const Eigen::Vector3d local = contact.frame.transpose() * kPush;
  constexpr double kTolerance = 1e-9;  // of warps that are the identity up to rounding
  EXPECT_NEAR(stated({.force = 0.3}), 0.3, kTolerance);
  EXPECT_NEAR(stated({.displacement = 0.02}), 0.02 * stiffness(contact.field, local).norm(),
              kTolerance);
  EXPECT_NEAR(stated({.across = 0.4}), 0.4 * force(contact.field, local).head<2>().norm(),
              kTolerance);
  EXPECT_NEAR(stated({.between = 10}), 0, 1e-6);  // the position is stored with 9 digits
  EXPECT_NEAR(stated({.force = 0.3, .across = 0.4}),
              std::hypot(0.3, 0.4 * force(contact.field, local).head<2>().norm()), kTolerance);
}

TEST(BlendedField, StatesErrorsThatGrowWithTheDistance) {
  Model model = sheet_model();
  for (ContactModel& contact : model.contacts)
    contact.uncertainty = ContactUncertainty{.between = 1e-4};
  const BlendedField field(model);
  const Eigen::Vector3d middle(0, -30, 700), push(0, 0, 2);  // of two contacts 60 mm apart
  EXPECT_NEAR(field.deviation(middle, push).value(),
              1e-4 * std::pow(30, 1.25) * field.force(middle, push).norm(), 1e-9);
}

TEST(BlendedField, StatesMoreBeyondTheContactsThanBetweenThem) {
  Model model = sheet_model();
  for (ContactModel& contact : model.contacts)
    contact.uncertainty = ContactUncertainty{.between = 1e-4};
  const BlendedField field(model);
  // Below the middle of an edge of the contacts, which are 30 mm from it, and 15 mm beyond.
  const Eigen::Vector3d beyond(0, -45, 700), push(0, 0, 2);
  const double square = 30 * 30 + geometry::kBeyondGrowth * 15 * 15;
  EXPECT_NEAR(
      field.deviation(beyond, push).value(),
      1e-4 * std::pow(square, geometry::kErrorGrowth / 2) * field.force(beyond, push).norm(), 1e-9);
}

TEST(BlendedField, StatesErrorsWhereCompliancesOfContactsDiffer) {
  Model model = sheet_model();
  // Springs along z that differ by a factor of four: in between, the compliance is the mean.
  for (std::size_t i = 0; i < 4; ++i) {
    ContactModel& contact = model.contacts[i];
    contact.field = {};
    for (int axis = 0; axis < 3; ++axis)
      contact.field.bases.push_back({.weight = (i % 2 == 0 ? 4000.0 : 1000.0),
                                     .epsilon = 1e3,
                                     .ridge = Eigen::Vector3d::Unit(axis)});
    contact.uncertainty = ContactUncertainty{};
  }
  model = with_compliances(std::move(model), 1);
  for (ContactModel& contact : model.contacts) contact.compliance->trend.setZero();
  const BlendedField field(model);
  const Eigen::Vector3d middle(0, -30, 700), push(0, 0, 0.5);
  const double soft = 1.0, stiff = 0.25, mean = (soft + stiff) / 2;
  const double square =
      (std::pow(std::log(mean / soft), 2) + std::pow(std::log(mean / stiff), 2)) / 2;
  EXPECT_NEAR(field.deviation(middle, push).value(),
              kContrastError * std::sqrt(square) * field.force(middle, push).norm(), 1e-4);
  EXPECT_NEAR(field.deviation(model.contacts[0].position, push).value(), 0, 1e-9);
}

TEST(BlendedField, GivesNoForceForWhatIsNotFinite) {
  const BlendedField field(uneven_model());
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(field.force(nan, kPush), Eigen::Vector3d::Zero());
  EXPECT_EQ(field.force({0, 0, 700}, nan), Eigen::Vector3d::Zero());
  EXPECT_TRUE(field.force({1e6, -1e6, 1e6}, {1e12, 0, 1e12}).allFinite());
}

TEST(FrictionParts, SplitAForceAlongAndAcrossTheAxis) {
  Blend at;
  at.friction = 0.5;
  const FrictionParts parts = friction_parts(at, {3, 4, 6});
  EXPECT_EQ(parts.normal, 6);
  EXPECT_EQ(parts.tangential, 5);
  EXPECT_EQ(parts.excess, 2);
}

TEST(BlendedField, RefusesABadModel) {
  Model model = uneven_model();
  model.contacts[0].field.bases[0].epsilon = -1;
  EXPECT_THAT(refusal([&] { return BlendedField(model); }), ::testing::HasSubstr("epsilon"));
}

}  // namespace
}  // namespace palpate::haptics
