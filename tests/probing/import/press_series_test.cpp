// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/press_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "refusal.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kStiffness = 0.8;  // [N/mm] of a spring whose surface is at z = 0
const Eigen::Vector3d kBias(0.3, -0.2, 1.7);

/// A tip on the way z(t) at 200 Hz onto the spring, with a sensor that has a bias.
TipSeries spring_series(double duration, const std::function<double(double)>& z, double delay = 0,
                        double noise = 0) {
  const auto count = static_cast<Eigen::Index>(std::lround(200 * duration));
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  TipSeries series{{}, Eigen::Matrix3Xd::Zero(3, count), Eigen::Matrix3Xd::Zero(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double time = 0.005 * static_cast<double>(i);
    series.time.push_back(time);
    series.tip(2, i) = z(time);
    series.force.col(i) = kBias;
    series.force(2, i) += -kStiffness * std::max(0.0, -z(time - delay));
    for (Eigen::Index k = 0; k < 3; ++k) series.force(k, i) += noise * normal(random);
  }
  return series;
}

/// Free for a second, down by 4 mm/s for a second, held for a second, and back: twice.
double presses_at(double time) {
  const double t = std::fmod(time, 4);
  if (t < 1) return 1;
  if (t < 2) return 1 - 4 * (t - 1);
  if (t < 3) return -3;
  return -3 + 4 * (t - 3);
}

TEST(PressSeries, HasTheForceAndPositionOfEachHoldAndTheTouch) {
  const SeriesPresses found = find_presses(spring_series(8, presses_at));
  ASSERT_EQ(found.presses.size(), 2u);
  for (const SeriesPress& press : found.presses) {
    EXPECT_LT((press.tare - kBias).norm(), 1e-9);
    // The spring gives 0.1 N where the touch is noticed, and begins at the surface.
    EXPECT_NEAR(press.depth, 0.1 / kStiffness, 1e-6);
    EXPECT_NEAR(press.touch.z(), 0, 1e-6);
    EXPECT_LT(press.depth_deviation, 1e-4);
    EXPECT_FALSE(press.slid);
    ASSERT_EQ(press.held.size(), 1u);
    // At both ends, half of the window of the speed still sees the motion.
    EXPECT_LT((press.held[0].force - Eigen::Vector3d(0, 0, -3 * kStiffness)).norm(), 0.02);
    EXPECT_NEAR(press.held[0].tip.z(), -3, 0.02);
    EXPECT_NEAR(press.held[0].force.z(), kStiffness * press.held[0].tip.z(), 1e-9);
  }
  EXPECT_NEAR(found.presses[1].time - found.presses[0].time, 4, 1e-9);
  EXPECT_GT(found.fast, 200u);
}

TEST(PressSeries, DividesASlowPressIntoSamplesOfLimitedLength) {
  // 3 mm at 0.3 mm/s.
  const auto slow = [](double t) { return t < 1 ? 1 : t < 2 ? 2 - t : -0.3 * (t - 2); };
  const SeriesPresses found = find_presses(spring_series(12, slow));
  ASSERT_EQ(found.presses.size(), 1u);
  const std::vector<HeldPress>& held = found.presses[0].held;
  EXPECT_GE(held.size(), 3 / 0.2 - 2);
  EXPECT_LE(held.size(), 3 / 0.2 + 2);
  for (const HeldPress& piece : held)
    EXPECT_NEAR(piece.force.z(), kStiffness * piece.tip.z(), 1e-9);
  for (std::size_t i = 1; i < held.size(); ++i) EXPECT_LT(held[i].tip.z(), held[i - 1].tip.z());
  // Ten times as fast, it has none.
  const auto fast = [&](double t) { return t < 2 ? slow(t) : -3 * (t - 2); };
  EXPECT_TRUE(find_presses(spring_series(3, fast)).presses.at(0).held.empty());
  EXPECT_FALSE(find_presses(spring_series(3, fast), {.highest_speed = 3.1, .sample_time = 0.05})
                   .presses.at(0)
                   .held.empty());
}

TEST(PressSeries, PairsPositionsWithForcesThatAreRecordedLater) {
  constexpr double kDelay = 0.0525;  // between two moments
  const auto slow = [](double t) { return t < 2 ? 1 : 1 - 0.4 * (t - 2); };
  const TipSeries series = spring_series(10, slow, kDelay);
  const SeriesPresses late = find_presses(series);
  const SeriesPresses right = find_presses(series, {.force_delay = kDelay});
  const auto largest_error = [](const SeriesPresses& found) {
    double error = 0;
    for (const HeldPress& piece : found.presses.at(0).held)
      error = std::max(error, std::abs(piece.force.z() - kStiffness * piece.tip.z()));
    return error;
  };
  EXPECT_NEAR(largest_error(late), kStiffness * 0.4 * kDelay, 1e-6);
  EXPECT_LT(largest_error(right), 1e-9);
  EXPECT_EQ(right.unpaired, 11u);  // 52.5 ms at 200 Hz, at the end
}

TEST(PressSeries, LeavesOutMomentsAtTheLimitOfTheSensor) {
  TipSeries series = spring_series(8, presses_at);
  series.saturated.assign(series.time.size(), false);
  // Half of the first hold.
  std::size_t count = 0;
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    if (series.time[i] < 2 || series.time[i] > 2.5) continue;
    series.saturated[i] = true;
    series.force.col(static_cast<Eigen::Index>(i)).z() = -100;
    ++count;
  }
  const SeriesPresses found = find_presses(series);
  EXPECT_EQ(found.saturated, count);
  ASSERT_EQ(found.presses.at(0).held.size(), 1u);
  EXPECT_NEAR(found.presses[0].held[0].force.z(), -3 * kStiffness, 0.02);
}

TEST(PressSeries, IsFoundInNoise) {
  // 5 standard deviations of one component are half of the touch force.
  const SeriesPresses found = find_presses(spring_series(16, presses_at, 0, 0.01));
  ASSERT_EQ(found.presses.size(), 4u);
  for (const SeriesPress& press : found.presses) {
    EXPECT_LT((press.tare - kBias).norm(), 0.01 * std::sqrt(3.0 / 40) * 4);
    EXPECT_LT(std::abs(press.touch.z()), 4 * press.depth_deviation);
    EXPECT_LT(press.depth_deviation, 0.5 * 0.1 / kStiffness);
    ASSERT_EQ(press.held.size(), 1u);
    EXPECT_NEAR(press.held[0].force.z(), kStiffness * press.held[0].tip.z(), 0.01);
  }
}

TEST(PressSeries, WithoutTareTakesForcesAsTheyAre) {
  TipSeries series = spring_series(8, presses_at);
  EXPECT_THAT(refusal([&] { return find_presses(series, {.tare = false}); }),
              AllOf(HasSubstr("in contact from the beginning"), HasSubstr("touch_force")));
  series.force.colwise() -= kBias;
  const SeriesPresses found = find_presses(series, {.tare = false});
  ASSERT_EQ(found.presses.size(), 2u);
  EXPECT_TRUE(found.presses[0].tare.isZero(0));
}

/// A press 2.5 mm deep onto the spring, a slow motion aside, and the release. The surface is
/// dragged along with 0.5 N/mm until friction of 0.6 yields.
TipSeries dragged_series(double aside, double speed) {
  TipSeries series = spring_series(3 + aside / speed + 2, [&](double time) {
    const double end = 3 + aside / speed;
    return time < 1     ? 1
           : time < 2   ? 1 - 3.5 * (time - 1)
           : time < end ? -2.5
                        : -2.5 + 3 * (time - end);
  });
  double held = 0;
  for (Eigen::Index i = 0; i < series.tip.cols(); ++i) {
    const double depth = std::max(0.0, -series.tip(2, i)), limit = 0.6 * kStiffness * depth;
    const double x = std::clamp(speed * (series.time[static_cast<std::size_t>(i)] - 3), 0.0, aside);
    held = depth > 0 ? std::clamp(held, x - limit / 0.5, x + limit / 0.5) : x;
    series.tip(0, i) = x;
    series.force(0, i) += 0.5 * (x - held);
  }
  return series;
}

TEST(PressSeries, KeepsADragThatHoldsAndLeavesOutWhatFollowsASlide) {
  // Friction yields at 2.4 mm.
  const SeriesPresses held = find_presses(dragged_series(0.9, 0.4));
  ASSERT_EQ(held.presses.size(), 1u);
  EXPECT_FALSE(held.presses[0].slid);
  EXPECT_GT(held.presses[0].held.back().force.x(), 0.35);

  const SeriesPresses slid = find_presses(dragged_series(12, 0.4));
  ASSERT_EQ(slid.presses.size(), 1u);
  const SeriesPress& press = slid.presses[0];
  EXPECT_TRUE(press.slid);
  for (const HeldPress& piece : press.held) EXPECT_LT(piece.tip.x(), 2.5);
  EXPECT_GT(press.held.back().tip.x(), 1.8);
  ASSERT_TRUE(press.slip);
  EXPECT_NEAR(press.slip->force.x() / -press.slip->force.z(), 0.6, 0.05);
}

TEST(PressSeries, NoticesAFastSlideToo) {
  const SeriesPresses fast = find_presses(dragged_series(20, 40));
  ASSERT_EQ(fast.presses.size(), 1u);
  EXPECT_TRUE(fast.presses[0].slid);
  // The hold before it is whole.
  ASSERT_EQ(fast.presses[0].held.size(), 1u);
  EXPECT_NEAR(fast.presses[0].held[0].tip.x(), 0, 0.05);
  EXPECT_FALSE(find_presses(dragged_series(20, 40), {.slide_length = 30}).presses[0].slid);
}

TEST(PressSeries, ThatIsDamagedIsRefused) {
  const TipSeries right = spring_series(4, presses_at);
  const auto refused = [](const TipSeries& series, const SeriesOptions& options = {}) {
    return refusal([&] { return find_presses(series, options); });
  };
  TipSeries series = right;
  series.time[7] = series.time[6];
  EXPECT_THAT(refused(series), AllOf(HasSubstr("moment 8"), HasSubstr("times must ascend")));
  series = right;
  series.force(1, 3) = NAN;
  EXPECT_THAT(refused(series), AllOf(HasSubstr("moment 4"), HasSubstr("not finite")));
  series = right;
  series.time.pop_back();
  EXPECT_THAT(refused(series), HasSubstr("differ in their number"));
  EXPECT_THAT(refused(right, {.touch_force = -1}), HasSubstr("SeriesOptions::touch_force is -1"));
  EXPECT_THAT(refused(right, {.force_delay = INFINITY}), HasSubstr("SeriesOptions::force_delay"));
  EXPECT_TRUE(find_presses({}).presses.empty());
}

}  // namespace
}  // namespace palpate::probing
