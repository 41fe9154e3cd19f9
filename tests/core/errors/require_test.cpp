// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/require.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "not_finite.h"
#include "palpate/core/error.h"

namespace palpate {
namespace {

/// The message of `require` for a value, "" if it accepts it.
template <typename Value>
std::string message(Value value, const Interval& range, const char* unit = "") {
  try {
    require("Options::size", value, range, unit);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

bool passes(double value, const Interval& range) { return message(value, range).empty(); }

TEST(Require, HoldsOpenAndClosedEndsToTheLastDigit) {
  const double after_zero = std::nextafter(0.0, 1.0);
  const double after_one = std::nextafter(1.0, 2.0);
  const double before_one = std::nextafter(1.0, 0.0);
  EXPECT_FALSE(passes(0, above(0)));
  EXPECT_FALSE(passes(-0.0, above(0)));
  EXPECT_TRUE(passes(after_zero, above(0)));
  EXPECT_TRUE(passes(0, at_least(0)));
  EXPECT_TRUE(passes(-0.0, at_least(0)));
  EXPECT_FALSE(passes(-after_zero, at_least(0)));
  EXPECT_TRUE(passes(1, above(0).at_most(1)));
  EXPECT_FALSE(passes(after_one, above(0).at_most(1)));
  EXPECT_FALSE(passes(1, above(0).below(1)));
  EXPECT_TRUE(passes(before_one, above(0).below(1)));
  EXPECT_FALSE(passes(0, above(0).below(1)));
  EXPECT_TRUE(passes(0, at_least(0).below(1)));
}

TEST(Require, LetsNaNPassNowhere) {
  for (const Interval& range : {Interval{}, finite(), at_least(0), above(0), at_least(0).finite(),
                                above(0).at_most(1), at_least(0).below(1), Interval{}.below(1)}) {
    EXPECT_FALSE(passes(kNaN, range)) << to_string(range);
    EXPECT_FALSE(message(std::optional<double>(kNaN), range).empty()) << to_string(range);
  }
  EXPECT_EQ(message(kNaN, above(0)), "Options::size is nan; it must be > 0");
}

TEST(Require, LetsInfinityPassOnlyWhereTheRangeHasIt) {
  EXPECT_TRUE(passes(kInf, above(0)));
  EXPECT_TRUE(passes(kInf, at_least(0)));
  EXPECT_FALSE(passes(-kInf, at_least(0)));
  EXPECT_FALSE(passes(kInf, above(0).finite()));
  EXPECT_FALSE(passes(kInf, finite()));
  EXPECT_FALSE(passes(-kInf, finite()));
  EXPECT_FALSE(passes(kInf, above(0).at_most(1)));
  EXPECT_TRUE(passes(-kInf, Interval{}.below(1)));
  EXPECT_FALSE(passes(-kInf, Interval{}.below(1).finite()));
}

TEST(Require, FiniteNumbersAreSmallEnoughForProductsOfThree) {
  EXPECT_TRUE(std::isfinite(kLargestNumber * kLargestNumber * kLargestNumber));
  const double beyond = std::nextafter(kLargestNumber, kInf);
  for (const Interval& range : {finite(), above(0).finite(), at_least(2).finite()}) {
    EXPECT_TRUE(passes(kLargestNumber, range)) << to_string(range);
    EXPECT_FALSE(passes(beyond, range)) << to_string(range);
  }
  EXPECT_TRUE(passes(-kLargestNumber, Interval{}.below(1).finite()));
  EXPECT_FALSE(passes(-beyond, Interval{}.below(1).finite()));
  EXPECT_TRUE(passes(beyond, above(0)));
  EXPECT_EQ(message(1e300, above(0).finite(), "mm"),
            "Options::size is 1e+300 mm; it must be at most 1e+100 in magnitude");
  EXPECT_EQ(message(-1e300, finite()),
            "Options::size is -1e+300; it must be at most 1e+100 in magnitude");
  EXPECT_EQ(message(-1e300, above(0).finite()),
            "Options::size is -1e+300; it must be > 0 and finite");
  EXPECT_EQ(message(1e300, above(0).at_most(1)), "Options::size is 1e+300; it must be in (0, 1]");
}

TEST(Require, NamesTheFieldTheValueAndTheRange) {
  EXPECT_EQ(message(-1, above(0), "mm"), "Options::size is -1 mm; it must be > 0");
  EXPECT_EQ(message(0.1, at_least(0.25).at_most(4)),
            "Options::size is 0.1; it must be in [0.25, 4]");
  EXPECT_EQ(message(kInf, above(0).finite(), "px"),
            "Options::size is inf px; it must be > 0 and finite");
  EXPECT_EQ(message(4, above(0).below(std::numbers::pi), "rad"),
            "Options::size is 4 rad; it must be in (0, pi)");
  EXPECT_EQ(message(-1e-9, at_least(0).at_most(std::numbers::pi / 2)),
            "Options::size is -1e-09; it must be in [0, pi/2]");
}

TEST(Require, WritesIntegersAsIntegers) {
  EXPECT_EQ(message(0, at_least(1).at_most(64)), "Options::size is 0; it must be in [1, 64]");
  EXPECT_EQ(message(std::numeric_limits<int>::min(), at_least(0)),
            "Options::size is -2147483648; it must be >= 0");
  EXPECT_EQ(message(std::numeric_limits<int>::max(), at_least(0).at_most(1000000)),
            "Options::size is 2147483647; it must be in [0, 1000000]");
}

TEST(Require, DescribesEveryKindOfRange) {
  EXPECT_EQ(to_string(Interval{}), "a number");
  EXPECT_EQ(to_string(finite()), "finite");
  EXPECT_EQ(to_string(at_least(2)), ">= 2");
  EXPECT_EQ(to_string(at_least(2).finite()), ">= 2 and finite");
  EXPECT_EQ(to_string(Interval{}.at_most(2)), "<= 2");
  EXPECT_EQ(to_string(Interval{}.below(2).finite()), "< 2 and finite");
  EXPECT_EQ(to_string(above(-10).at_most(10)), "in (-10, 10]");
}

TEST(Require, AsksNothingOfAnOptionThatIsNotGiven) {
  EXPECT_EQ(message(std::optional<double>(), above(0)), "");
  EXPECT_EQ(message(std::optional<double>(2), above(0)), "");
  EXPECT_EQ(message(std::optional<int>(), at_least(4)), "");
  EXPECT_EQ(message(std::optional<int>(3), at_least(4)), "Options::size is 3; it must be >= 4");
}

TEST(Require, MakesANameOnlyForAMessage) {
  int made = 0;
  const auto name = [&] {
    ++made;
    return std::string("vertex ") + std::to_string(7);
  };
  require(name, 1, above(0));
  EXPECT_EQ(made, 0);
  EXPECT_THROW(require(name, kNaN, above(0)), InvalidInput);
  EXPECT_EQ(made, 1);
  try {
    require(name, -1, above(0), "mm");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "vertex 7 is -1 mm; it must be > 0");
  }
}

TEST(Require, AsksForWhatHasNoDefault) {
  EXPECT_NO_THROW(require_given("edge_length", true));
  EXPECT_THROW(require_given("edge_length", false), InvalidInput);
}

TEST(Require, ListsTheChoicesThatThereAre) {
  EXPECT_NO_THROW(require_one_of("bits", 16, {8, 16}));
  const auto message_of = [](int value) {
    try {
      require_one_of("terms", value, {0, 2, 4, 5});
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message_of(5), "");
  EXPECT_EQ(message_of(3), "terms is 3; it must be 0, 2, 4 or 5");
}

}  // namespace
}  // namespace palpate
