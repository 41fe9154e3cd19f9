// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/contact_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sheet_model.h"

namespace palpate::haptics {
namespace {

TouchPoint slip(const Model& model, const Eigen::Vector3d& contact, const Eigen::Vector3d& tool) {
  const BlendedField field(model);
  return slip_contact(field, geometry::triangle_normals(model.surface),
                      {contact, {0, 0, -1}, field.surface().closest_point(contact).at}, tool);
}

// Force along the displacement, axis along the normal: the tool must come to lie on the cone of
// displacements with slope mu.
TEST(SlipContact, LetsAnIsotropicContactTrailByFrictionTimesDepth) {
  for (const double friction : {0.0, 0.3, 0.9}) {
    const TouchPoint found = slip(sheet_model(friction), {-5, 2, 700}, {15, 2, 706});
    // Brent's method finds t to 2^-14 of a step of at most 10 mm.
    EXPECT_NEAR(found.position.x(), 15 - friction * 6, 2e-3) << friction;
    EXPECT_NEAR(found.position.y(), 2, 1e-9);
    EXPECT_NEAR(found.position.z(), 700, 1e-12);
    EXPECT_GE(found.at.triangle, 0);
    EXPECT_EQ(found.normal, Eigen::Vector3d(0, 0, -1));
  }
}

TEST(SlipContact, StopsAtTheNearSideOfTheConeAfterATinyStep) {
  // A step of 1 um beyond the cone: the far side would be 2 * 0.5 * 6 mm away.
  const TouchPoint found = slip(sheet_model(0.5), {0, 0, 700}, {3.001, 0, 706});
  EXPECT_NEAR(found.position.x(), 0.001, 2e-4);
}

TEST(SlipContact, EndsOnTheConeWhereFieldsFramesAndFrictionDiffer) {
  const Model model = uneven_model();
  const BlendedField field(model);
  const Eigen::Vector3d tool(14, 8, 706);
  const Eigen::Vector3d before(-10, 0, 700);
  EXPECT_GT(friction_parts(field.blend(before), field.force(before, tool - before)).excess, 0.3);
  const TouchPoint found = slip(model, before, tool);
  const FrictionParts after = friction_parts(field.blend(found.position),
                                             field.force(found.position, tool - found.position));
  EXPECT_NEAR(after.excess, 0, 1e-3);
  EXPECT_GT(after.normal, 0);
}

TEST(SlipContact, MovesInThePlaneOfToolAndFrictionAxis) {
  Model model = sheet_model(0.4);
  for (ContactModel& contact : model.contacts)
    contact.friction_axis = Eigen::Vector3d(0.2, -0.3, 1).normalized();
  const Eigen::Vector3d before(-5, 2, 700), tool(15, 9, 706);
  const TouchPoint found = slip(model, before, tool);
  const Eigen::Vector3d across =
      (tool - before).cross(model.contacts[0].friction_axis).normalized();
  EXPECT_NEAR(across.dot(found.position - before), 0, 1e-9);
  EXPECT_GT((found.position - before).norm(), 1);
}

TEST(SlipContact, StaysOnTheSurfaceBeyondItsBorder) {
  const TouchPoint found = slip(sheet_model(0.3), {45, 0, 700}, {80, 0, 705});
  EXPECT_LE(found.position.x(), 50);
  EXPECT_NEAR(found.position.z(), 700, 1e-12);
}

// Figure 5.6: without friction's change the boundary slides to the tool exactly.
TEST(SlipByBoundary, IsExactWhereFieldAndFrictionAreTheSameEverywhere) {
  for (const double friction : {0.0, 0.3, 0.9}) {
    const BlendedField field(sheet_model(friction));
    const Eigen::Vector3d contact(-5, 2, 700), tool(15, 2, 706);
    const TouchPoint found =
        slip_by_boundary(field, geometry::triangle_normals(sheet_model().surface),
                         {contact, {0, 0, -1}, field.surface().closest_point(contact).at}, tool);
    EXPECT_NEAR(found.position.x(), 15 - friction * 6, 1e-5) << friction;
    EXPECT_NEAR(found.position.y(), 2, 1e-9);
  }
}

TEST(SlipByBoundary, MissesTheConeWhereFrictionDiffersUnlikeTheSearch) {
  const Model model = uneven_model();
  const BlendedField field(model);
  const Eigen::Vector3d before(-10, 0, 700), tool(14, 8, 706);
  const TouchPoint contact{before, {0, 0, -1}, field.surface().closest_point(before).at};
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(model.surface);
  const auto excess = [&](const TouchPoint& at) {
    const Eigen::Vector3d force = field.force(at.position, tool - at.position);
    return std::abs(friction_parts(field.blend(at.at), force).excess);
  };
  EXPECT_GT(excess(slip_by_boundary(field, normals, contact, tool)), 0.005);
  EXPECT_LT(excess(slip_contact(field, normals, contact, tool)), 1e-3);
}

}  // namespace
}  // namespace palpate::haptics
