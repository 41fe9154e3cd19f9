// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/simpler_fields.h"

#include <gtest/gtest.h>

#include "sheet_model.h"

namespace palpate::haptics {
namespace {

Model with_field(const ForceField& field) {
  Model model = sheet_model();
  for (ContactModel& contact : model.contacts) contact.field = field;
  return model;
}

const std::vector<double> kDepths(4, 3.0);  // [mm]

TEST(SimplifyFields, JoinsBasesThatAreOne) {
  Model model = with_field({{{.weight = 1, .epsilon = 8}, {.weight = 3, .epsilon = 8}}});
  EXPECT_EQ(simplify_fields(model, 0.01, kDepths), 4);
  const ForceField one = spring(4, 8);
  const Eigen::Matrix3Xd displacements = random_points(50, 3);
  for (const ContactModel& contact : model.contacts) {
    EXPECT_EQ(contact.field.bases.size(), 1U);
    for (const auto& d : displacements.colwise())
      EXPECT_LT((force(contact.field, d) - force(one, d)).norm(), 0.03);
  }
}

TEST(SimplifyFields, StayWithinTheErrorAndPassive) {
  const ForceField field = {{{.weight = 2, .epsilon = 5},
                             {.weight = 1, .epsilon = 3, .center = {0.5, 0, 2}},
                             {.weight = 3, .epsilon = 4, .ridge = Eigen::Vector3d::UnitZ()},
                             {.weight = 0.3, .epsilon = 2, .center = {-1, 1, 1}}}};
  const Eigen::Matrix3Xd displacements = random_points(2000, 3);
  for (const double error : {0.02, 0.1, 0.4}) {
    Model model = with_field(field);
    simplify_fields(model, error, kDepths);
    double sum = 0;
    int count = 0;
    for (const auto& d : displacements.colwise()) {
      if (!(d.z() > 0 && d.head<2>().norm() < 0.7 * d.z())) continue;  // a press, and a drag
      sum += (force(model.contacts[0].field, d) - force(field, d)).squaredNorm();
      ++count;
    }
    EXPECT_LT(std::sqrt(sum / count), 1.3 * error);
    for (const Multiquadric& base : model.contacts[0].field.bases) EXPECT_GE(base.weight, 0);
  }
}

TEST(SimplifyFields, LeaveAFieldThatHasNoSimplerOne) {
  Model model = with_field(spring(4, 10));
  EXPECT_EQ(simplify_fields(model, 0.1, kDepths), 0);
  Model uneven = uneven_model();
  EXPECT_EQ(simplify_fields(uneven, 1e-9, kDepths), 0);
  EXPECT_EQ(uneven.contacts[2].field, uneven_model().contacts[2].field);
}

TEST(SimplifyFields, AreNotFittedAgainWithinAnErrorThatIsKnownToBeTooSmall) {
  const ForceField twice = {{{.weight = 1, .epsilon = 8}, {.weight = 3, .epsilon = 8}}};
  Model model = with_field(twice);
  std::vector<double> too_small{-1, 0.01, 0.02, 0.005};
  EXPECT_EQ(simplify_fields(model, 0.01, kDepths, too_small), 2);
  EXPECT_EQ(too_small, (std::vector<double>{-1, 0.01, 0.02, 0.005}));
  EXPECT_EQ(model.contacts[1].field, twice);
  EXPECT_EQ(model.contacts[2].field, twice);
  Model single = with_field(spring(4, 10));
  EXPECT_EQ(simplify_fields(single, 0.1, kDepths, too_small), 0);
  EXPECT_EQ(too_small, std::vector<double>(4, 0.1));
}

}  // namespace
}  // namespace palpate::haptics
