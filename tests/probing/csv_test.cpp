// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "probing_testing.h"

namespace palpate::probing {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::array<std::string_view, 2> kColumns = {"b", "a"};

CsvTable table_of(const std::string& text) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "t.csv";
  write_text(path, text);
  return {path, kColumns};
}

std::string refused(const std::string& text) {
  return refusal([&] { return table_of(text).number(0, 1); });
}

TEST(Csv, FindsColumnsByNameInAnyOrderAndIgnoresOthers) {
  const CsvTable table = table_of("a,extra,b\n1,x,2\n\n3,y,4\n");
  ASSERT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.number(0, 0), 2);
  EXPECT_EQ(table.number(0, 1), 1);
  EXPECT_EQ(table.number(1, 0), 4);
  EXPECT_EQ(table.line(1), 4u);
}

TEST(Csv, ReadsWindowsLinesAByteOrderMarkAndALastLineWithoutEnd) {
  const CsvTable table = table_of(
      "\xEF\xBB\xBF"
      "a, b\r\n 1.5 ,-2e3\r\n+3,4");
  ASSERT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.number(0, 1), 1.5);
  EXPECT_EQ(table.number(0, 0), -2000);
  EXPECT_EQ(table.number(1, 1), 3);
  EXPECT_EQ(table.number(1, 0), 4);
}

TEST(Csv, ReadsBackWhatNeedsQuotes) {
  for (const std::string& text :
       std::vector<std::string>{"plain", "with,comma", "with \"quote\"", " blank ", ""}) {
    const CsvTable table = table_of("a,b\n1," + to_cell(text) + "\n");
    EXPECT_EQ(table.text(0, 0), text);
  }
  EXPECT_THROW(static_cast<void>(to_cell("two\nlines")), InvalidInput);
}

TEST(Csv, NumbersReadBackExactly) {
  for (const double value : {0.1, -1.0 / 3, 1e-320, std::numeric_limits<double>::max(), 5e-324}) {
    EXPECT_EQ(table_of("a,b\n" + to_text(value) + ",0\n").number(0, 1), value);
  }
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(-12LL), "-12");
}

TEST(Csv, NamesFileLineColumnTextAndWhatIsRight) {
  for (const std::string& text :
       std::vector<std::string>{"abc", "", "nan", "inf", "1.5x", "1 2", "0x10", "+-1"}) {
    EXPECT_THAT(refused("a,b\n" + text + ",0\n"),
                AllOf(HasSubstr("t.csv"), HasSubstr("line 2"), HasSubstr("column 'a'"),
                      HasSubstr("'" + text + "'"), HasSubstr("finite number")));
  }
  EXPECT_THAT(refusal([] { return table_of("a,b\n1.5,0\n").integer(0, 1); }),
              HasSubstr("whole number"));
  EXPECT_THAT(refusal([] { return table_of("a,b\n2,0\n").flag(0, 1); }), HasSubstr("0 or 1"));
}

TEST(Csv, RefusesWhatIsNotSuchATable) {
  EXPECT_THAT(refused(""), HasSubstr("empty"));
  EXPECT_THAT(refused("a,c\n1,2\n"), AllOf(HasSubstr("no column 'b'"), HasSubstr("b,a")));
  EXPECT_THAT(refused("a,b,a\n1,2,3\n"), HasSubstr("'a' is there twice"));
  EXPECT_THAT(refused("a,b\n1,2\n1\n"), AllOf(HasSubstr("line 3"), HasSubstr("1 cells")));
  EXPECT_THAT(refused("a,b\n1,2,3\n"), AllOf(HasSubstr("line 2"), HasSubstr("3 cells")));
  EXPECT_THAT(refused("a,b\n\"1,2\n"), AllOf(HasSubstr("line 2"), HasSubstr("quote")));
  EXPECT_THAT(refused(std::string("\x89PNG\r\n\0\1\2,", 10)), HasSubstr("no column"));
  EXPECT_THAT(refused("a,b\n\x01\x02" + std::string(100, 'x') + ",2\n"), HasSubstr("'??xxx"));
  const ScratchFolder folder;
  EXPECT_THAT(refusal([&] { CsvTable(folder / "none.csv", kColumns); }),
              AllOf(HasSubstr("none.csv"), HasSubstr("no such file")));
}

}  // namespace
}  // namespace palpate::probing
