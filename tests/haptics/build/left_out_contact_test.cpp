// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/left_out_contact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "haptics_testing.h"
#include "model/contact_places.h"
#include "palpate/geometry/surface_query.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<geometry::SurfacePoint> places_of(const Model& model) {
  return contact_places(model, geometry::SurfaceQuery(model.surface));
}

TEST(LeftOutContact, LeavesOneTriangleOfASquare) {
  const Model model = sheet_model();
  const Model rest = LeftOutModels(model, places_of(model)).without(1);
  ASSERT_EQ(rest.contacts.size(), 3u);
  EXPECT_EQ(rest.contacts[0].id, 10);
  EXPECT_EQ(rest.contacts[1].id, 12);
  EXPECT_EQ(rest.contacts[2].id, 13);
  EXPECT_EQ(rest.triangles.cols(), 1);
  EXPECT_NO_THROW(check_model(rest));
}

TEST(LeftOutContact, DoesNotKeepHowTheSurfaceFollowsAllContacts) {
  Model model = sheet_model();
  model.response.emplace();
  const Model rest = LeftOutModels(model, places_of(model)).without(1);
  EXPECT_FALSE(rest.response.has_value());
  EXPECT_NO_THROW(check_model(rest));
}

TEST(LeftOutContact, RefusesPointsOfOtherContacts) {
  const Model model = sheet_model();
  std::vector<geometry::SurfacePoint> places = places_of(model);
  EXPECT_THAT(refusal([&] { return LeftOutModels(model, places).without(4); }),
              HasSubstr("contact 4"));
  places.pop_back();
  EXPECT_THAT(refusal([&] { return LeftOutModels(model, places); }), HasSubstr("3 points"));
}

TEST(LeftOutContact, TellsWhichContactsAreAtTheBorder) {
  Model model = sheet_model();
  EXPECT_THAT(border_contacts(model), ElementsAre(true, true, true, true));
  ContactModel middle = model.contacts[0];
  middle.position << 0, 0, 700;
  model.contacts.push_back(middle);
  model.triangles.resize(3, 4);
  model.triangles << 0, 1, 3, 2,  //
      1, 3, 2, 0,                 //
      4, 4, 4, 4;
  EXPECT_THAT(border_contacts(model), ElementsAre(true, true, true, true, false));
}

}  // namespace
}  // namespace palpate::haptics
