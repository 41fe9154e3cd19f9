// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "records/probing_testing.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::array<std::string_view, 2> kLetterColumns = {"b", "a"};

// Before the first row. An open file can be read even after its folder is gone.
CsvReader reader_of(const std::string& text, const TableLayout& layout = {}) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "t.csv";
  write_text(path, text);
  return {path, kLetterColumns, layout};
}

// Columns b and a of each row.
std::vector<std::array<double, 2>> rows_of(const std::string& text,
                                           const TableLayout& layout = {}) {
  CsvReader row = reader_of(text, layout);
  std::vector<std::array<double, 2>> rows;
  while (row.next()) rows.push_back({row.number(0), row.number(1)});
  return rows;
}

std::string refused_csv(const std::string& text) {
  return refusal([&] { return rows_of(text); });
}

TEST(Csv, FindsColumnsByNameInAnyOrderAndIgnoresOthers) {
  CsvReader row = reader_of("a,extra,b\n1,x,2\n\n3,y,4\n");
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.line(), 2u);
  EXPECT_EQ(row.number(0), 2);
  EXPECT_EQ(row.number(1), 1);
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.line(), 4u);
  EXPECT_EQ(row.number(0), 4);
  EXPECT_EQ(row.number(1), 3);
  EXPECT_FALSE(row.next());
}

TEST(Csv, ReadsWindowsLinesAByteOrderMarkAndALastLineWithoutEnd) {
  EXPECT_THAT(rows_of("\xEF\xBB\xBF"
                      "a, b\r\n 1.5 ,-2e3\r\n+3,4"),
              ::testing::ElementsAre(std::array{-2000.0, 1.5}, std::array{4.0, 3.0}));
}

TEST(Csv, ReadsBackWhatNeedsQuotes) {
  for (const std::string& text :
       std::vector<std::string>{"plain", "with,comma", "with \"quote\"", " blank ", ""}) {
    for (const std::string& line : {"1," + to_cell(text), "\"1\"," + to_cell(text) + "\r"}) {
      CsvReader row = reader_of("a,b\n" + line + "\n");
      ASSERT_TRUE(row.next());
      EXPECT_EQ(row.text(0), text);
      EXPECT_EQ(row.integer(1), 1);
    }
  }
  EXPECT_THROW(static_cast<void>(to_cell("two\nlines")), InvalidInput);
}

TEST(Csv, NumbersReadBackExactly) {
  for (const double value : {0.1, -1.0 / 3, 1e-320, std::numeric_limits<double>::max(), 5e-324}) {
    EXPECT_EQ(rows_of("a,b\n" + to_text(value) + ",0\n").at(0)[1], value);
  }
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(-12LL), "-12");
}

TEST(Csv, NamesFileLineColumnTextAndWhatIsRight) {
  for (const std::string& text :
       std::vector<std::string>{"abc", "", "nan", "inf", "1.5x", "1 2", "0x10", "+-1"}) {
    EXPECT_THAT(refused_csv("a,b\n" + text + ",0\n"),
                AllOf(HasSubstr("t.csv"), HasSubstr("line 2"), HasSubstr("column 'a'"),
                      HasSubstr("'" + text + "'"), HasSubstr("finite number")));
  }
  CsvReader row = reader_of("a,b\n1.5,2\n");
  ASSERT_TRUE(row.next());
  EXPECT_THAT(refusal([&] { return row.integer(1); }), HasSubstr("whole number"));
  EXPECT_THAT(refusal([&] { return row.flag(0); }), HasSubstr("0 or 1"));
}

TEST(Csv, DetectsTheSeparatorInTheFirstLineOrTakesTheOneThatIsTold) {
  const auto expected = ::testing::ElementsAre(std::array{-2000.0, 1.5});
  EXPECT_THAT(rows_of("a;b\n1.5;-2e3\n"), expected);
  EXPECT_THAT(rows_of("a\tb\r\n1.5\t-2e3\r\n"), expected);
  EXPECT_THAT(rows_of("a;\"x, y, z\";b\n1.5;\"1,2,3\";-2e3\n"), expected);
  EXPECT_THAT(rows_of("a|b\n1.5|-2e3\n", {.separator = '|'}), expected);
  EXPECT_THAT(rows_of("a,b\n\n\"1.5\",-2e3\n", {.separator = ','}), expected);
  EXPECT_THAT(refused_csv("a;b\n1,5;2\n"),
              AllOf(HasSubstr("column 'a'"), HasSubstr("'1,5'"), HasSubstr("decimal point"),
                    Not(HasSubstr("mapping"))));
  EXPECT_THAT(refusal([&] { return rows_of("a;b\n1,5;2\n", {.mapped = true}); }),
              HasSubstr("--decimal comma, or decimal: comma in a mapping"));
  EXPECT_THAT(refused_csv("a b\n1 2\n"),
              AllOf(HasSubstr("one cell, 'a b'"), HasSubstr("separated by commas")));
  EXPECT_THAT(refusal([&] { return rows_of("a b\n1 2\n", {.mapped = true}); }),
              HasSubstr("Give the separator"));
}

TEST(Csv, TakesColumnsUnderTheNamesThatTheyHaveInTheFile) {
  const TableLayout layout{.names = {{"a", "Force X"}, {"b", "id"}}};
  EXPECT_THAT(rows_of("id,Force X,a\n7,1.5,9\n", layout),
              ::testing::ElementsAre(std::array{7.0, 1.5}));
  EXPECT_THAT(refusal([&] { return rows_of("id,Force X,a\n7,x,9\n", layout); }),
              HasSubstr("column 'Force X'"));
  EXPECT_THAT(refusal([&] { return rows_of("id,a\n7,x,9\n", layout); }),
              AllOf(HasSubstr("no column 'Force X' (for a)"), HasSubstr("it names 'id,a'")));
}

TEST(Csv, ReadsDecimalCommasIfItIsTold) {
  const TableLayout comma{.decimal_comma = true};
  const auto expected = ::testing::ElementsAre(std::array{-2000.5, 1.5});
  EXPECT_THAT(rows_of("a;b\n1,5;-2000,5\n", comma), expected);
  EXPECT_THAT(rows_of("a, in N;a;b\n7;1,5;-2,0005e3\n", comma), expected);
  EXPECT_THAT(rows_of("a,b\n\"1,5\",\"-2000,5\"\n", {.separator = ',', .decimal_comma = true}),
              expected);
  // A number in place of a name has a point, as in a mapping.
  EXPECT_THAT(rows_of("b;c\n-2000,5;1\n", {.decimal_comma = true, .names = {{"a", "1.5"}}}),
              expected);
  for (const char* cell : {"1.5", "1.234,5", "1,234,5"}) {
    EXPECT_THAT(refusal([&] { return rows_of("a;b\n" + std::string(cell) + ";2\n", comma); }),
                AllOf(HasSubstr("line 2, column 'a'"), HasSubstr("decimal comma"),
                      HasSubstr("without signs between the thousands")))
        << cell;
  }
}

TEST(Csv, NamesSignsBetweenThousands) {
  for (const std::string& cell :
       std::vector<std::string>{"1,234.5", "1'234.5", "12 345", "1.234.567"}) {
    EXPECT_THAT(refused_csv("a\tb\n" + cell + "\t2\n"),
                AllOf(HasSubstr("line 2, column 'a'"), HasSubstr("'" + cell + "'"),
                      HasSubstr("without signs between the thousands")));
  }
}

TEST(Csv, ReadsFilesWithoutALineOfNamesByTheNumbersOfTheirColumns) {
  const TableLayout layout{.header = false, .names = {{"a", "column_3"}, {"b", "-column_1"}}};
  EXPECT_THAT(rows_of("7;x;1.5\n\n8;y;2.5\n", layout),
              ::testing::ElementsAre(std::array{-7.0, 1.5}, std::array{-8.0, 2.5}));
  EXPECT_THAT(refusal([&] { return rows_of("7;1.5\n", layout); }),
              AllOf(HasSubstr("no column 'column_3' (for a)"), HasSubstr("column_1 to column_2")));
  EXPECT_THAT(refusal([&] { return rows_of("7;x;1.5\n7;1.5\n", layout); }),
              AllOf(HasSubstr("line 2: 2 cells"), HasSubstr("has 3 columns")));
  EXPECT_THAT(refusal([&] { return rows_of("n;x;F\n7;y;1.5\n", layout); }),
              AllOf(HasSubstr("line 1, column 'column_1': found 'n'"), HasSubstr("finite number")));
  // The first row is not lost silently.
  const TableLayout forgotten{.mapped = true, .names = {{"a", "column_2"}, {"b", "column_1"}}};
  EXPECT_THAT(refusal([&] { return rows_of("7;1.5\n8;2.5\n", forgotten); }),
              AllOf(HasSubstr("line 1: holds numbers only"), HasSubstr("header: false")));
  EXPECT_THAT(refused_csv("7,1.5\n8,2.5\n"),
              AllOf(HasSubstr("numbers only"), Not(HasSubstr("mapping"))));
}

TEST(Csv, TakesAColumnWhoseNameIsThereTwiceByItsNumber) {
  const TableLayout layout{.names = {{"a", "column_3"}}};
  EXPECT_THAT(rows_of("a,b,a\n1,2,3\n", layout), ::testing::ElementsAre(std::array{2.0, 3.0}));
  EXPECT_THAT(refused_csv("a,b,a\n1,2,3\n"),
              AllOf(HasSubstr("'a' is there twice"), HasSubstr("such as column_1")));
}

TEST(Csv, PointsAtAColumnOfNearlyThatName) {
  EXPECT_THAT(refused_csv("a (mN),b\n1,2\n"), HasSubstr("no column 'a', but 'a (mN)'"));
  EXPECT_THAT(refused_csv("\"A\",b\n1,2\n"), HasSubstr("no column 'a', but 'A'"));
}

TEST(Csv, TakesANumberThatNamesNoColumnForAllRows) {
  const TableLayout layout{.names = {{"a", "0"}}};
  EXPECT_THAT(rows_of("b\n7\n8\n", layout),
              ::testing::ElementsAre(std::array{7.0, 0.0}, std::array{8.0, 0.0}));
  EXPECT_THAT(rows_of("b,0\n7,3\n", layout), ::testing::ElementsAre(std::array{7.0, 3.0}));
  CsvReader row = reader_of("b\n7\n", {.names = {{"a", ""}}});
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.text(1), "");
  EXPECT_THAT(refusal([&] { return row.number(1); }), HasSubstr("column 'a'"));
}

TEST(Csv, TellsWhichColumnIsMissing) {
  try {
    static_cast<void>(reader_of("b,c\n1,2\n"));
    FAIL() << "nothing was refused";
  } catch (const MissingColumn& missing) {
    EXPECT_EQ(missing.name, "a");
  }
}

TEST(Csv, RefusesWhatIsNotSuchATable) {
  EXPECT_THAT(refused_csv(""), HasSubstr("empty"));
  EXPECT_THAT(refused_csv("a,c\n1,2\n"), AllOf(HasSubstr("no column 'b'"), HasSubstr("b,a")));
  EXPECT_THAT(refused_csv("a,b,a\n1,2,3\n"), HasSubstr("'a' is there twice"));
  EXPECT_THAT(refused_csv("a,b\n1,2\n1\n"), AllOf(HasSubstr("line 3"), HasSubstr("1 cells")));
  EXPECT_THAT(refused_csv("a,b\n1,2,3\n"), AllOf(HasSubstr("line 2"), HasSubstr("3 cells")));
  EXPECT_THAT(refused_csv("a,b\n\"1,2\n"), AllOf(HasSubstr("line 2"), HasSubstr("quote")));
  EXPECT_THAT(refused_csv("a,b\n\"1\"0,2\n"), AllOf(HasSubstr("line 2"), HasSubstr("quote")));
  EXPECT_THAT(refused_csv(std::string("\x89PNG\r\n\0\1\2,", 10)), HasSubstr("no text file"));
  EXPECT_THAT(refused_csv("PK\3\4a,b\n1,2\n"), AllOf(HasSubstr("t.csv"), HasSubstr("(.xlsx")));
  EXPECT_THAT(refused_csv("a,b\n\x01\x02" + std::string(100, 'x') + ",2\n"), HasSubstr("'??xxx"));
  const ScratchFolder folder;
  EXPECT_THAT(refusal([&] { CsvReader(folder / "none.csv", kLetterColumns); }),
              AllOf(HasSubstr("none.csv"), HasSubstr("no such file")));
}

}  // namespace
}  // namespace palpate::probing
