// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "not_finite.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

TEST(DepthDifference, IsSignedAndUnknownWhereEitherIs) {
  ImageF a = ImageF::Constant(2, 3, 700.5f);
  ImageF b = ImageF::Constant(2, 3, 700.0f);
  a(0, 0) = kUnknown;
  b(1, 2) = kUnknown;
  const ImageF difference = depth_difference(a, b);
  EXPECT_TRUE(std::isnan(difference(0, 0)));
  EXPECT_TRUE(std::isnan(difference(1, 2)));
  EXPECT_EQ(difference(0, 1), 0.5f);
}

TEST(DepthDifference, RefusesMapsOfDifferentSize) {
  EXPECT_THROW((void)depth_difference(ImageF::Zero(2, 3), ImageF::Zero(3, 2)), InvalidInput);
}

TEST(RangeMapScore, CountsWhatIsFoundAndWhatIsWrong) {
  ImageF truth = ImageF::Constant(2, 5, 1000.0f);
  truth.col(4) = kUnknown;
  ImageF measured = truth;
  measured(0, 0) = 1000.5f;   // within the bound
  measured(0, 1) = 1010.0f;   // beyond it
  measured(1, 1) = kUnknown;  // not found
  measured(0, 4) = 900.0f;    // found where nothing is
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> measurable(2, 5);
  measurable << 1, 1, 1, 0, 0,  //
      1, 1, 1, 1, 0;
  const RangeMapScore score = score_range_map(measured, truth, measurable, 5);
  EXPECT_DOUBLE_EQ(score.reconstructed, 6.0 / 7);
  EXPECT_DOUBLE_EQ(score.wrong, 2.0 / 8);
  EXPECT_EQ(score.error.count, 7);
  EXPECT_DOUBLE_EQ(score.error.max, 10);
  EXPECT_DOUBLE_EQ(score.distance, 1000);
}

TEST(RangeMapScore, RefusesAnErrorThatNothingCanBeBelow) {
  const ImageF z = ImageF::Constant(2, 3, 700);
  const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> all = z > 0;
  EXPECT_THROW((void)score_range_map(z, z, all, 0), InvalidInput);
  EXPECT_THROW((void)score_range_map(z, z, all, kNaN), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
