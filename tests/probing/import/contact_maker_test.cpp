// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/contact_maker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "refusal.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::filesystem::path kFile = "lab.csv";

TEST(ContactMaker, TakesPlacesUpToSamePlaceFromTheFirstAsOneContact) {
  ContactMaker maker(1);
  EXPECT_EQ(maker.add({0, 0, 5}, {kFile, 1}), 1);
  EXPECT_EQ(maker.add({1, 0, 5}, {kFile, 2}), 1);    // just as far as same_place
  EXPECT_EQ(maker.add({1.5, 0, 5}, {kFile, 3}), 2);  // 1.5 mm from the first place
  EXPECT_EQ(maker.add({1, 0, 5}, {kFile, 4}), 2);    // nearer to the second contact
  for (const long long id : {1, 2}) maker.add_normal(id, {0, 0, 1});
  const std::vector<Contact> made = maker.contacts();
  ASSERT_EQ(made.size(), 2u);
  EXPECT_EQ(made[0].position, Eigen::Vector3d(0.5, 0, 5));
  EXPECT_EQ(made[1].position, Eigen::Vector3d(1.25, 0, 5));
}

TEST(ContactMaker, HasTheMeanDirectionOfTheNormalsOrForces) {
  ContactMaker maker(1);
  maker.add(7, {0, 0, 0}, {kFile, 1});
  maker.add_normal(7, {0, 3, 0});
  maker.add_normal(7, {0, 0, 3});
  const std::vector<Contact> made = maker.contacts();
  EXPECT_EQ(made.at(0).id, 7);
  EXPECT_LT((made[0].normal - Eigen::Vector3d(0, std::sqrt(0.5), std::sqrt(0.5))).norm(), 1e-15);
  maker.add_normal(7, {0, -3, -3});
  maker.add_normal(7, {0, 0, -0.5});
  EXPECT_THAT(refusal([&] { return maker.contacts(); }),
              AllOf(HasSubstr("contact 7"), HasSubstr("give nx,ny,nz")));
}

TEST(ContactMaker, NamesTheRowOfAContactThatMoved) {
  ContactMaker maker(0.5);
  maker.add(7, {0, 0, 0}, {kFile, 1});
  const auto move = [&](double x) {
    return refusal([&] {
      maker.add(7, {x, 0, 0}, {kFile, 2});
      return 0;
    });
  };
  EXPECT_THAT(move(2),
              AllOf(HasSubstr("lab.csv: row 2: contact 7 is 2 mm"), HasSubstr("(0.5 mm)")));
  EXPECT_THAT(move(NAN), HasSubstr("row 2"));
  EXPECT_THAT(refusal([] {
                return checked_normal({0, 0, 2}, {kFile, 4});
              }),
              AllOf(HasSubstr("row 4"), HasSubstr("length 2")));
}

}  // namespace
}  // namespace palpate::probing
