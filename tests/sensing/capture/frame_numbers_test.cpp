// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/frame_numbers.h"

#include <gtest/gtest.h>

#include <vector>

namespace palpate::sensing {
namespace {

TEST(NumbersByCounter, BeginAtZeroAndLeaveOutWhatIsMissing) {
  NumbersByCounter numbers;
  EXPECT_EQ(numbers.next(500), 0U);
  EXPECT_EQ(numbers.next(501), 1U);
  EXPECT_EQ(numbers.next(505), 5U);
}

TEST(NumbersByCounter, GoOnWhereACounterOfSixteenBitsBeginsAgain) {
  NumbersByCounter numbers;
  EXPECT_EQ(numbers.next(65534), 0U);
  EXPECT_EQ(numbers.next(65535), 1U);
  EXPECT_EQ(numbers.next(1), 2U);
  NumbersByCounter with_loss;
  EXPECT_EQ(with_loss.next(65535), 0U);
  EXPECT_EQ(with_loss.next(3), 3U);
  NumbersByCounter with_zero;
  EXPECT_EQ(with_zero.next(65535), 0U);
  EXPECT_EQ(with_zero.next(0), 1U);
}

TEST(NumbersByCounter, LongCountersNeverBeginAgain) {
  NumbersByCounter numbers;
  EXPECT_EQ(numbers.next(65535), 0U);
  EXPECT_EQ(numbers.next(65536), 1U);
  EXPECT_EQ(numbers.next(1), 2U);  // the camera restarted: the number of lost frames is unknown
}

TEST(NumbersByCounter, ACounterThatStandsStillLosesNothing) {
  NumbersByCounter numbers;  // of a driver that gives every frame the number 0
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(numbers.next(0), i);
}

TEST(NumbersByTime, AnIntervalOfThreeUsualOnesLosesTwoFrames) {
  NumbersByTime numbers(100);
  EXPECT_EQ(numbers.next(5.0), 0U);
  EXPECT_EQ(numbers.next(5.0102), 1U);
  EXPECT_EQ(numbers.next(5.0398), 4U);
}

TEST(NumbersByTime, ACameraThatExposesLongerInTheDarkLosesNothing) {
  NumbersByTime numbers(30);
  double time = 0;
  std::uint64_t number = 0;
  for (int i = 0; i < 10; ++i) number = numbers.next(time += 1.0 / 30);
  const std::uint64_t before = number;
  for (int i = 0; i < 40; ++i) number = numbers.next(time += 1.0 / 15);
  // Until the longer interval is the usual one, each counts as two.
  EXPECT_LE(number - before, 40U + 9U);
  EXPECT_EQ(numbers.next(time += 1.0 / 15), number + 1);
}

TEST(NumbersByTime, WithoutAKnownRateTheFirstIntervalsTellIt) {
  NumbersByTime numbers(0);
  for (int i = 0; i <= 4; ++i) EXPECT_EQ(numbers.next(0.02 * i), static_cast<std::uint64_t>(i));
  EXPECT_EQ(numbers.next(0.02 * 7), 7U);
}

}  // namespace
}  // namespace palpate::sensing
