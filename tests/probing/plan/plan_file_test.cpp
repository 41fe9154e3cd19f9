// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "palpate/core/error.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/contact_plan.h"

namespace palpate::probing {
namespace {

using ::testing::HasSubstr;

ContactPlan some_plan() {
  return plan_contacts(make_specimen(Beam{})->surface(),
                       {.spacing = 11.3, .contacts = 7, .sensor = {1, 2, -3}});
}

TEST(PlanFile, GivesBackThePlanToTheLastDigit) {
  ContactPlan plan = some_plan();
  plan.cover = std::numeric_limits<double>::infinity();
  const ContactPlan read = parse_plan(to_text(plan), "plan.json");
  ASSERT_EQ(read.contacts.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(read.contacts[i].id, plan.contacts[i].id);
    EXPECT_EQ(read.contacts[i].position, plan.contacts[i].position);
    EXPECT_EQ(read.contacts[i].normal, plan.contacts[i].normal);
  }
  EXPECT_EQ(read.cover, plan.cover);
  EXPECT_EQ(read.normal_forces, plan.normal_forces);
  EXPECT_EQ(read.excluded, plan.excluded);
  EXPECT_EQ(read.surface, plan.surface);
  EXPECT_EQ(read.options.sensor, plan.options.sensor);
  EXPECT_EQ(to_text(read), to_text(plan));
}

TEST(PlanFile, KnowsItsSurface) {
  geometry::TriangleMesh mesh = make_specimen(Beam{})->surface();
  EXPECT_EQ(some_plan().surface, surface_fingerprint(mesh));
  mesh.vertices(2, 17) += 1e-9;
  EXPECT_NE(some_plan().surface, surface_fingerprint(mesh));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

TEST(PlanFile, SaysWhatIsWrong) {
  const std::string right = to_text(some_plan());
  const auto refused = [](const std::string& text) -> std::string {
    try {
      (void)parse_plan(text, "plan.json");
    } catch (const FileError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(refused("1"), HasSubstr("plan.json: is not a JSON object"));
  EXPECT_THAT(refused(replaced(right, "palpate contact plan", "map")), HasSubstr("'format'"));
  EXPECT_THAT(refused(replaced(right, "\"version\": 1", "\"version\": 2")),
              HasSubstr("is of version 2"));
  EXPECT_THAT(refused(replaced(right, "\"contacts\"", "\"places\"")), HasSubstr("contacts"));
  EXPECT_THAT(refused(replaced(right, "\"id\": 1,", "\"id\": 0,")), HasSubstr("0"));
  EXPECT_THAT(refused(replaced(right, " 2.6\n", " 7.0\n")), HasSubstr("'normal_forces' has 7.0"));
  EXPECT_THROW((void)read_plan("/nowhere/plan.json"), FileError);
}

}  // namespace
}  // namespace palpate::probing
