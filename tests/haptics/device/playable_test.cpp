// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/playable.h"

#include <gmock/gmock.h>

#include <limits>

#include "refusal.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

template <typename Change>
std::string refused_to_play(Change&& change) {
  Model model = sheet_model();
  change(model);
  return refusal([&] {
    check_playable(model);
    return 0;
  });
}

TEST(CheckPlayable, AcceptsAModelWithContactsOnItsSurface) {
  Model model = sheet_model();
  EXPECT_NO_THROW(check_playable(model));
  model.contacts[2].position.z() += 4;
  EXPECT_NO_THROW(check_playable(model));
}

TEST(CheckPlayable, NamesAContactOffTheSurface) {
  EXPECT_THAT(refused_to_play([](Model& m) { m.contacts[1].position.z() += 300; }),
              AllOf(HasSubstr("contact 11 lies 300"), HasSubstr("mm off the surface")));
  EXPECT_THAT(refused_to_play([](Model& m) { m.contacts[1].position.x() = 1e9; }),
              HasSubstr("contact 11"));
}

TEST(CheckPlayable, RefusesAMillionBases) {
  EXPECT_THAT(refused_to_play([](Model& m) {
                m.contacts[3].field.bases.resize(1'000'000, m.contacts[3].field.bases[0]);
              }),
              AllOf(HasSubstr("contact 13 has 1000000 bases"), HasSubstr("--max-bases")));
}

TEST(CheckPlayable, RefusesNumbersThatAreNotFinite) {
  EXPECT_THAT(refused_to_play([](Model& m) {
                m.contacts[0].field.bases[0].weight = std::numeric_limits<double>::quiet_NaN();
              }),
              HasSubstr("contact 10"));
  EXPECT_THAT(refused_to_play([](Model& m) {
                m.contacts[2].friction_axis.y() = std::numeric_limits<double>::quiet_NaN();
              }),
              HasSubstr("contact 12"));
}

}  // namespace
}  // namespace palpate::haptics
