// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/column_units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refused_units(const AcquisitionMapping& mapping) {
  return refusal([&] {
    check_units_of_names(mapping);
    return 0;
  });
}

TEST(ColumnUnits, InNamesMustBeThoseOfTheMapping) {
  const ColumnNames names = {
      {"pz", "Fz (mN)"}, {"ax", "X [m]"}, {"time", "t (ms)"}, {"depth", "-d (m) "}};
  EXPECT_NO_THROW(
      check_units_of_names({.columns = names, .length = 1000, .force = 1e-3, .time = 1e-3}));
  EXPECT_THAT(refused_units({.columns = names, .length = 1000, .time = 1e-3}),
              AllOf(HasSubstr("'pz' is the column 'Fz (mN)', in mN"), HasSubstr("0.001 times"),
                    HasSubstr("force: mN")));
  EXPECT_THAT(refused_units({.columns = names, .force = 1e-3, .time = 1e-3}),
              AllOf(HasSubstr("'X [m]'"), HasSubstr("length: m")));
  EXPECT_THAT(refused_units({.columns = names, .length = 1000, .force = 1e-3}),
              HasSubstr("time: ms"));
}

TEST(ColumnUnits, AreNotSeenInOtherBracketsOrColumns) {
  EXPECT_NO_THROW(check_units_of_names({.columns = {{"pz", "Fz (raw)"},
                                                    {"ax", "data.P(:,2)"},
                                                    {"ay", "P(2,:)"},
                                                    {"az", ""},
                                                    {"slipped", "slip (N)"},
                                                    {"nx", "n (m)"},
                                                    {"py", ")"},
                                                    {"px", "0"}}}));
}

}  // namespace
}  // namespace palpate::probing
