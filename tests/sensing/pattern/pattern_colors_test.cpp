// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/pattern_colors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "image/hue.h"
#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

/// A camera whose filters bend the hues: a hue projected as h is seen as bent(h).
double bent(double hue) { return hue + 0.25 * std::sin(2 * hue + 0.3); }

TrainedColors seen_colors(int count, double (*response)(double), double deviation) {
  TrainedColors trained;
  for (const PatternColor& color : evenly_spaced_colors(count)) {
    const double hue = static_cast<double>(hue_of(static_cast<float>(color.rgb[0]),
                                                  static_cast<float>(color.rgb[1]),
                                                  static_cast<float>(color.rgb[2]))
                                               .angle);
    double mean = std::fmod(response(hue), 2 * std::numbers::pi);
    if (mean < 0) mean += 2 * std::numbers::pi;
    trained.colors.push_back({color.name, mean, deviation * deviation, 1000});
  }
  return trained;
}

TEST(PatternColors, SixAreTheCornersOfTheColourCube) {
  const std::vector<PatternColor> colors = evenly_spaced_colors(6);
  const std::vector<PatternColor> expected = {{"R", {1, 0, 0}}, {"Y", {1, 1, 0}}, {"G", {0, 1, 0}},
                                              {"C", {0, 1, 1}}, {"B", {0, 0, 1}}, {"M", {1, 0, 1}}};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(colors[i].name, expected[i].name);
    EXPECT_LT((colors[i].rgb - expected[i].rgb).norm(), 1e-12);  // a few roundings of values <= 1
  }
}

TEST(PatternColors, HaveNamesOfTheirOwnAndTheHuesThoseSay) {
  for (int count = 2; count <= 24; ++count) {
    std::set<std::string> names;
    const std::vector<PatternColor> colors = evenly_spaced_colors(count);
    ASSERT_EQ(static_cast<int>(colors.size()), count);
    for (int i = 0; i < count; ++i) {
      const PatternColor& color = colors[static_cast<std::size_t>(i)];
      names.insert(color.name);
      const Hue hue = hue_of(static_cast<float>(color.rgb[0]), static_cast<float>(color.rgb[1]),
                             static_cast<float>(color.rgb[2]));
      EXPECT_FLOAT_EQ(hue.saturation, 1);
      EXPECT_NEAR(wrap(static_cast<double>(hue.angle) - i * 360.0 / count * kDegree), 0,
                  0.501 * kDegree);
      if (color.name[0] == 'H') {
        EXPECT_NEAR(static_cast<double>(hue.angle), std::stoi(color.name.substr(1)) * kDegree,
                    1e-6);
      }
    }
    EXPECT_EQ(static_cast<int>(names.size()), count);
  }
}

TEST(PatternColors, StayWhereTheyAreIfTheCameraSeesThemEvenly) {
  const SpreadColors spread = spread_colors(seen_colors(
                                                6, [](double hue) { return hue + 0.4; }, 0.1),
                                            6);
  const std::vector<PatternColor> even = evenly_spaced_colors(6);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(spread.colors[i].name, even[i].name);
}

TEST(PatternColors, StayWhereTheyAreIfTheyAreHardlyEverConfused) {
  const SpreadColors spread = spread_colors(seen_colors(6, bent, 0.05), 6);
  EXPECT_EQ(spread.colors[1].name, "Y");
  EXPECT_EQ(spread.expected[1].mean, seen_colors(6, bent, 0.05).colors[1].mean);
  EXPECT_NE(spread_colors(seen_colors(6, bent, 0.2), 6).colors[1].name, "Y");
}

TEST(PatternColors, AreSpreadEvenlyForABentResponse) {
  const TrainedColors trained = seen_colors(24, bent, 0.1);
  for (const int count : {3, 5, 6, 8}) {
    const SpreadColors spread = spread_colors(trained, count);
    ASSERT_EQ(static_cast<int>(spread.colors.size()), count);
    for (std::size_t i = 0; i < spread.expected.size(); ++i) {
      const TrainedColor& next = spread.expected[(i + 1) % spread.expected.size()];
      // Whole degrees, of which the response makes at most 1.5.
      EXPECT_NEAR(std::abs(wrap(next.mean - spread.expected[i].mean)), 2 * std::numbers::pi / count,
                  1.6 * kDegree);
      // The expected hues are those that this camera would see, up to the linear interpolation.
      const Eigen::Vector3f rgb = spread.colors[i].rgb.cast<float>();
      const auto hue = static_cast<double>(hue_of(rgb[0], rgb[1], rgb[2]).angle);
      EXPECT_NEAR(wrap(spread.expected[i].mean - bent(hue)), 0, 0.01);
    }
    EXPECT_LE(largest_overlap(spread.expected),
              largest_overlap(seen_colors(count, bent, 0.1).colors) * (1 + 1e-9));
  }
}

TEST(PatternColors, ThatAreSeenLessSharplyGetMoreRoom) {
  TrainedColors trained = seen_colors(
      6, [](double hue) { return hue; }, 0.05);
  trained.colors[2].variance = 0.3 * 0.3;  // green: 3 apart
  const SpreadColors spread = spread_colors(trained, 6);
  const Eigen::MatrixXd separation = hue_separation(spread.expected);
  const Eigen::MatrixXd before = hue_separation(trained.colors);
  double least = 1e9;
  for (int i = 0; i < 6; ++i) {
    least = std::min(least, separation(i, (i + 1) % 6));
  }
  EXPECT_GT(least, 2 * before(1, 2));
  EXPECT_LT(largest_overlap(spread.expected), largest_overlap(trained.colors));
}

TEST(PatternColors, OverlapIsTheGaussianTail) {
  const std::vector<TrainedColor> colors = {{"R", 0.2, 0.01, 1}, {"Y", 0.8, 0.04, 1}};
  // 0.6 / (0.1 + 0.2) = 2 deviations: a tail of 0.02275.
  EXPECT_NEAR(hue_separation(colors)(0, 1), 2, 1e-12);
  EXPECT_NEAR(largest_overlap(colors), 0.02275013, 1e-8);
}

TEST(PatternColors, RefuseWhatCannotBeInterpolated) {
  const auto refusal_of = [](const TrainedColors& trained, int count) {
    return message_of<InvalidInput>([&] { (void)spread_colors(trained, count); });
  };
  TrainedColors trained = seen_colors(6, bent, 0.1);
  EXPECT_THAT(refusal_of(trained, 1), HasSubstr("in [2, 24]"));
  EXPECT_THAT(refusal_of(trained, 25), HasSubstr("in [2, 24]"));
  std::swap(trained.colors[0].mean, trained.colors[3].mean);
  EXPECT_THAT(refusal_of(trained, 6), HasSubstr("order"));
  trained = seen_colors(6, bent, 0.1);
  trained.colors[1].name = "olive";
  EXPECT_THAT(refusal_of(trained, 6), HasSubstr("olive"));
  trained = seen_colors(6, bent, 0.1);
  trained.colors[1].variance = -1;
  EXPECT_THAT(refusal_of(trained, 6), HasSubstr("Y"));
  trained.colors.resize(2);
  trained.colors[1].variance = 1;
  EXPECT_THAT(refusal_of(trained, 6), HasSubstr("at least 3"));
}

}  // namespace
}  // namespace palpate::sensing
