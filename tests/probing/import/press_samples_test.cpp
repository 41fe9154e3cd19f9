// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/press_samples.h"

#include <gtest/gtest.h>

#include <vector>

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

/// A piece of a press onto 0.5 N/mm along -z and 0.4 N/mm along x.
HeldPress piece(double time, double x, double z) {
  return {time, {x, 0, z}, {0.4 * x, 0, 0.5 * z}};
}

TEST(PressSamples, OfPressesHaveNoDrag) {
  const PressSamples found =
      samples_of_press({.held = {piece(1, 0, -1), piece(2, 0.1, -2), piece(3, 0, -1)}}, 0.1);
  ASSERT_EQ(found.samples.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_FALSE(found.dragged[i]);
    EXPECT_EQ(found.samples[i].a, found.samples[i].b);
  }
  EXPECT_LT((found.samples[1].force - Vector3d(0.04, 0, -1)).norm(), 1e-15);
  EXPECT_EQ(found.samples[1].time, 2);
  EXPECT_TRUE(samples_of_press({}, 0.1).samples.empty());
}

TEST(PressSamples, AreNoDragsIfTheForceTurnsWithoutTheTip) {
  // The tip goes straight down onto a slope, whose force turns.
  const PressSamples found =
      samples_of_press({.held = {{1, {0, 0, -1}, {0, 0, -1}}, {2, {0, 0, -2}, {0.6, 0, -2}}}}, 0.1);
  EXPECT_EQ(found.dragged, (std::vector<bool>{false, false}));
  EXPECT_EQ(found.samples[1].a, Vector3d(0, 0, -2));
}

TEST(PressSamples, OfDragsHaveTheirPositionUnderTheNormalForceAlone) {
  const PressSamples found = samples_of_press(
      {.held = {piece(1, 0, -1), piece(2, 0, -3), piece(3, 2, -2.5), piece(4, -2, -1)}}, 0.1);
  ASSERT_EQ(found.samples.size(), 4u);
  EXPECT_EQ(found.dragged, (std::vector<bool>{false, false, true, true}));
  EXPECT_LT((found.samples[2].a - Vector3d(0, 0, -2.5)).norm(), 1e-12);
  EXPECT_EQ(found.samples[2].b, Vector3d(2, 0, -2.5));
  EXPECT_LT((found.samples[2].force - Vector3d(0.8, 0, -1.25)).norm(), 1e-15);
  EXPECT_FALSE(found.samples[2].slipped);
  EXPECT_LT((found.samples[3].a - Vector3d(0, 0, -1)).norm(), 1e-12);
}

TEST(PressSamples, NeedAPressOfTheSameNormalForceForADrag) {
  // 0.5 N more than any press, and 0.05 N more, which is within the noise of forces.
  const PressSamples found =
      samples_of_press({.held = {piece(1, 0, -1), piece(2, 2, -2), piece(3, 2, -1.1)}}, 0.1);
  EXPECT_EQ(found.drags_without_base, 1u);
  ASSERT_EQ(found.samples.size(), 2u);
  EXPECT_EQ(found.samples[1].time, 3);
  EXPECT_EQ(found.samples[1].a, Vector3d(0, 0, -1));
}

TEST(PressSamples, HaveTheForceUnderWhichTheTipSlid) {
  SeriesPress press{.held = {piece(1, 0, -2)}, .slid = true};
  press.slip = piece(2, 1.5, -2);
  const PressSamples found = samples_of_press(press, 0.1);
  ASSERT_EQ(found.samples.size(), 2u);
  EXPECT_TRUE(found.samples[1].slipped);
  EXPECT_LT((found.samples[1].force - Vector3d(0.6, 0, -1)).norm(), 1e-15);
  EXPECT_EQ(found.samples[1].a, Vector3d(0, 0, -2));
}

}  // namespace
}  // namespace palpate::probing
