// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "field/rounded_number.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace palpate::haptics {
namespace {

// Long double has 11 bits more than double: its own errors do not count here.
static_assert(std::numeric_limits<long double>::digits >= 64);

struct Both {
  RoundedNumber rounded;
  long double exact;
};

void expect_holds(const Both& both) {
  EXPECT_LE(static_cast<long double>(both.rounded.lower()), both.exact);
  EXPECT_GE(static_cast<long double>(both.rounded.upper()), both.exact);
  EXPECT_LE(std::abs(both.exact - both.rounded.value), both.rounded.error);
}

// Numbers of many sizes that carry errors themselves.
Both some_number(std::mt19937& random) {
  std::uniform_real_distribution<double> digits(-1, 1), exponent(-12, 12);
  const double value = std::ldexp(digits(random), static_cast<int>(exponent(random)));
  const double error = 1e-9 * std::abs(digits(random));
  return {{value, error}, static_cast<long double>(value) + error * digits(random)};
}

TEST(RoundedNumber, EnclosesTheExactResultOfEachOperation) {
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    const Both a = some_number(random), b = some_number(random);
    expect_holds({a.rounded + b.rounded, a.exact + b.exact});
    expect_holds({a.rounded - b.rounded, a.exact - b.exact});
    expect_holds({a.rounded * b.rounded, a.exact * b.exact});
    expect_holds({a.rounded / b.rounded, a.exact / b.exact});
    expect_holds({-a.rounded, -a.exact});
    if (a.exact >= 0) expect_holds({sqrt(a.rounded), std::sqrt(a.exact)});
  }
}

TEST(RoundedNumber, FollowsCancellation) {
  // (1 + x)^2 - 1 - 2 x - x^2 is zero; what is computed is rounding alone.
  for (double x = 1e-9; x < 1; x *= 1.7) {
    const RoundedNumber one{1}, two{2}, number{x}, sum = one + number;
    const RoundedNumber rest = sum * sum - one - two * number - number * number;
    EXPECT_LE(rest.lower(), 0);
    EXPECT_GE(rest.upper(), 0);
    EXPECT_LT(rest.error, 1e-14);  // some operations on numbers near 1: the bound is of use
  }
}

TEST(RoundedNumber, SaysNothingWhereNothingIsCertain) {
  const RoundedNumber unclear{1e-9, 1e-8}, one{1};
  EXPECT_FALSE((one / unclear).lower() >= 0);
  EXPECT_FALSE((one / RoundedNumber{0}).lower() >= 0);
  const double huge = std::numeric_limits<double>::max();
  EXPECT_FALSE((RoundedNumber{huge} * RoundedNumber{huge}).lower() >= 0);
  // Underflow: the product is positive, but it is lost.
  EXPECT_GT((RoundedNumber{1e-300} * RoundedNumber{1e-300}).upper(), 0);
}

}  // namespace
}  // namespace palpate::haptics
