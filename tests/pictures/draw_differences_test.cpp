// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_differences.h"

#include <gtest/gtest.h>

#include "not_finite.h"
#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Six columns that show as six bands: far below, below, zero, above, wrong, unknown. Their median
/// error is 0.25 mm, so that the colours span 1 mm to each side.
geometry::RangeMapScore score_bands() {
  const geometry::ImageF errors =
      geometry::ImageF{{-4.0F, -0.25F, 0.0F, 0.25F, 20.0F, kFloatNaN}}.replicate(4, 1);
  const geometry::ImageF truth = geometry::ImageF::Constant(4, 6, 700);
  return geometry::score_range_map(truth + errors, truth);
}

cv::Mat3b differences_picture(const geometry::RangeMapScore& score) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_differences(png, score, "Differences"); });
}

/// The colour in the middle of band `index` of six; the image is 980 px wide, from x = 30.
Rgb band(const cv::Mat3b& picture, int index) { return pixel(picture, 30 + 82 + 163 * index, 477); }

TEST(DrawDifferences, ColoursFollowSignAndSizeAndWrongDepthsAreBlack) {
  const cv::Mat3b picture = differences_picture(score_bands());
  EXPECT_EQ(picture.size(), cv::Size(1200, 900));
  const auto expected = [](double fraction) { return color_at(ColorMap::diverging, fraction); };
  EXPECT_EQ(band(picture, 0), expected(0));
  EXPECT_LE(color_distance(band(picture, 1), expected(0.375)), 2);
  EXPECT_EQ(band(picture, 2), expected(0.5));
  EXPECT_LE(color_distance(band(picture, 3), expected(0.625)), 2);
  EXPECT_EQ(band(picture, 4), kBlack);
  EXPECT_EQ(band(picture, 5), kUnknownColor);
}

TEST(DrawDifferences, ViewFitsWhatWasMeasured) {
  // A patch of 20 x 15 pixels somewhere in an image of 640 x 480.
  geometry::ImageF truth = geometry::ImageF::Constant(480, 640, 700);
  geometry::ImageF measured = geometry::ImageF::Constant(480, 640, kFloatNaN);
  measured.block(300, 400, 15, 20).setConstant(701);
  const cv::Mat3b picture = differences_picture(geometry::score_range_map(measured, truth));
  const Region image(31, 90, 978, 780);
  const cv::Mat1b patch = mask_of(picture, color_at(ColorMap::diverging, 0.625), 2, image);
  EXPECT_GT(cv::countNonZero(patch), image.area() / 2);
}

TEST(DrawDifferences, DrawsAMapWithoutAnyErrorOrOnlyWithWrongDepths) {
  const geometry::ImageF truth = geometry::ImageF::Constant(4, 6, 700);
  EXPECT_EQ(band(differences_picture(geometry::score_range_map(truth, truth)), 2),
            color_at(ColorMap::diverging, 0.5));
  EXPECT_EQ(band(differences_picture(geometry::score_range_map(truth + 50, truth)), 2), kBlack);
}

TEST(DrawDifferences, RefusesMapsWithoutDepths) {
  const geometry::ImageF truth = geometry::ImageF::Constant(4, 6, 700);
  const geometry::RangeMapScore score = geometry::score_range_map(truth + kFloatNaN, truth);
  expect_refused([&](const std::filesystem::path& png) { draw_differences(png, score, ""); },
                 "no pixel was measured");
}

TEST(DrawDifferences, GivesTheSameBytesAgain) {
  expect_same_again(
      [](const std::filesystem::path& png) { draw_differences(png, score_bands(), "Again"); });
}

TEST(DrawDifferences, SaysWhenItCannotWrite) {
  expect_unwritable(
      [](const std::filesystem::path& png) { draw_differences(png, score_bands(), ""); });
}

}  // namespace
}  // namespace palpate::pictures
