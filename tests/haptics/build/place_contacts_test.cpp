// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/place_contacts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Presses along one direction on the flat surface: 7 x 8 contacts, three depths of a spring.
probing::Acquisition pressed_sheet() {
  probing::Acquisition acquisition;
  for (int i = 0; i < 56; ++i) {
    const probing::Contact contact{
        100 + i, {8.0 * (i % 7 - 3), 8.0 * (i / 7 - 3), 700}, {0, 0, -1}};
    acquisition.contacts.push_back(contact);
    for (const double depth : {1.0, 2.0, 3.0}) {
      const auto id = static_cast<long long>(acquisition.samples.size());
      acquisition.samples.push_back({.id = id,
                                     .contact = contact.id,
                                     .group = id,
                                     .force = {0, 0, 0.4 * depth},
                                     .a = contact.position + Eigen::Vector3d(0, 0, depth),
                                     .b = contact.position + Eigen::Vector3d(0, 0, depth)});
    }
  }
  return acquisition;
}

TEST(PlaceContacts, LeavesOutOneInFiftyContactsThatDoNotFitUnasked) {
  probing::Acquisition acquisition = pressed_sheet();
  acquisition.contacts[30].normal *= -1;
  const BuildResult result = build_model(acquisition, flat_surface());
  EXPECT_EQ(result.model.contacts.size(), 55u);
  ASSERT_EQ(result.left_out.size(), 1u);
  EXPECT_EQ(result.left_out[0].id, 130);
  EXPECT_THAT(result.left_out[0].reason, HasSubstr("points into the surface"));
  BuildOptions none;
  none.max_left_out = 0;
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), none); }),
              HasSubstr("contact 130"));
  acquisition.contacts[31].normal *= -1;
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface()); }),
              AllOf(HasSubstr("contact 130 has a normal that points into the surface"),
                    HasSubstr("2 contacts do not fit")));
}

TEST(PlaceContacts, KeepsAContactWhereASliverOfTheSurfaceIsFolded) {
  // At a contact in the corner of the sheet, a needle along its border is folded back: it faces
  // the other way, and has a larger angle there than the sheet.
  geometry::TriangleMesh surface = flat_surface();
  probing::Acquisition acquisition = pressed_sheet();
  const Eigen::Vector3d at = surface.vertices.col(0);
  const auto end = static_cast<int>(surface.vertices.cols());
  surface.vertices.conservativeResize(3, end + 1);
  surface.vertices.col(end) = at + Eigen::Vector3d(-9, 0.05, 0);
  // As the first triangle, it is the one to which a contact in the corner belongs.
  const Eigen::Matrix3Xi sheet = surface.triangles;
  surface.triangles.resize(3, sheet.cols() + 1);
  surface.triangles << Eigen::Vector3i(0, 1, end), sheet;
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(surface);
  ASSERT_GT(normals(2, 0), 0);
  ASSERT_LT(normals.rightCols(sheet.cols()).row(2).maxCoeff(), 0);
  ASSERT_GT(geometry::vertex_normals(surface)(2, 0), 0);
  const Eigen::Vector3d move = at - acquisition.contacts[0].position;
  acquisition.contacts[0].position += move;
  for (probing::Sample& sample : acquisition.samples) {
    if (sample.contact != acquisition.contacts[0].id) continue;
    sample.a += move;
    sample.b += move;
  }
  BuildOptions none;
  none.max_left_out = 0;
  const BuildResult result = build_model(acquisition, surface, none);
  EXPECT_EQ(result.model.contacts.size(), 56u);
}

TEST(PlaceContacts, KeepsContactsWhereTheyAreOnAnObjectFarFromTheOrigin) {
  // A power of two, so that the object is the same to the last bit.
  const Eigen::Vector3d far(0x1p30, -0x1p30, 0x1p31);
  probing::Acquisition acquisition = pressed_sheet();
  for (probing::Contact& contact : acquisition.contacts)
    contact.position += Eigen::Vector3d(0.123456, -0.234567, 0);
  const BuildResult here = build_model(acquisition, flat_surface());
  for (probing::Contact& contact : acquisition.contacts) contact.position += far;
  for (probing::Sample& sample : acquisition.samples) {
    sample.a += far;
    sample.b += far;
  }
  geometry::TriangleMesh surface = flat_surface();
  surface.vertices.colwise() += far;
  const BuildResult there = build_model(acquisition, surface);
  ASSERT_EQ(there.model.contacts.size(), here.model.contacts.size());
  for (std::size_t i = 0; i < here.model.contacts.size(); ++i) {
    const Eigen::Vector3d moved = there.model.contacts[i].position - far;
    // The ninth digit of the 141 mm of the object.
    EXPECT_LE((moved - here.model.contacts[i].position).cwiseAbs().maxCoeff(), 1.5e-6);
    EXPECT_LE(there.contacts[i].distance, 2e-6);
  }
}

}  // namespace
}  // namespace palpate::haptics
