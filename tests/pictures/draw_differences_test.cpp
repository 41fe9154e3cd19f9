// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_differences.h"

#include <gtest/gtest.h>

#include "not_finite.h"
#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Five columns that show as five bands: far below, below, zero, above, unknown.
const geometry::ImageF kBands =
    geometry::ImageF{{-9.0F, -0.25F, 0.0F, 0.25F, kFloatNaN}}.replicate(4, 1);

cv::Mat3b differences_picture(const geometry::ImageF& image, double limit) {
  return draw_picture([&](const std::filesystem::path& png) {
    draw_differences(png, image, "Differences", limit);
  });
}

/// The colour in the middle of band `index` of five; the image is 980 px wide, from x = 30.
Rgb band(const cv::Mat3b& picture, int index) { return pixel(picture, 30 + 98 + 196 * index, 477); }

TEST(DrawDifferences, ColoursFollowSignAndSize) {
  const cv::Mat3b picture = differences_picture(kBands, 0.5);
  EXPECT_EQ(picture.size(), cv::Size(1200, 900));
  const auto expected = [](double fraction) { return color_at(ColorMap::diverging, fraction); };
  EXPECT_EQ(band(picture, 0), expected(0));
  EXPECT_EQ(band(picture, 1), expected(0.25));
  EXPECT_EQ(band(picture, 2), expected(0.5));
  EXPECT_EQ(band(picture, 3), expected(0.75));
  EXPECT_EQ(band(picture, 4), kUnknownColor);
}

TEST(DrawDifferences, PalerUnderALargerLimit) {
  EXPECT_EQ(band(differences_picture(kBands, 1), 3), color_at(ColorMap::diverging, 0.625));
}

TEST(DrawDifferences, RefusesImagesWithoutValuesAndBadLimits) {
  geometry::ImageF image = kBands;
  double limit = 0;
  const auto attempt = [&](const std::filesystem::path& png) {
    draw_differences(png, image, "", limit);
  };
  for (const double bad : {0.0, -1.0, kInf, kNaN}) {
    limit = bad;
    expect_refused(attempt, "limit");
  }
  limit = 1;
  image.setConstant(kFloatNaN);
  expect_refused(attempt, "differences: holds no finite value");
  image.resize(0, 0);
  expect_refused(attempt, "differences: is empty");
}

TEST(DrawDifferences, GivesTheSameBytesAgain) {
  expect_same_again(
      [](const std::filesystem::path& png) { draw_differences(png, kBands, "Again", 1); });
}

TEST(DrawDifferences, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) { draw_differences(png, kBands, "", 1); });
}

}  // namespace
}  // namespace palpate::pictures
