// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_range_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "not_finite.h"
#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

constexpr int kCols = 64;
constexpr int kRows = 48;
/// Depth that grows by `per_col` and `per_row` mm.
geometry::RangeMap make_plane(float per_col, float per_row) {
  geometry::RangeMap map;
  map.z.resize(kRows, kCols);
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      map.z(row, col) =
          700.1F + per_col * static_cast<float>(col) + per_row * static_cast<float>(row);
    }
  }
  return map;
}

/// The place on the sequential map, in 0..1, of the colour at a fraction of the image.
double place_on_map(const cv::Mat3b& picture, double x, double y) {
  const Rgb color = pixel(picture, kImage.x + static_cast<int>(x * kImage.width),
                          kImage.y + static_cast<int>(y * kImage.height));
  int best = 256;
  double place = std::nan("");
  for (int step = 0; step <= 1000; ++step) {
    const int distance = color_distance(color, color_at(ColorMap::sequential, step / 1000.0));
    if (distance < best) {
      best = distance;
      place = step / 1000.0;
    }
  }
  EXPECT_LE(best, 2) << "a colour that is not on the map";
  return place;
}

cv::Mat3b range_map_picture(const geometry::RangeMap& map) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_range_map(png, map, "A plane"); });
}

/// The picture of a map at one depth, drawn once for all tests.
const cv::Mat3b& level_picture() {
  static const cv::Mat3b picture = range_map_picture(make_plane(0, 0));
  return picture;
}

TEST(DrawRangeMap, GivesAPictureOfTheStatedSize) {
  EXPECT_EQ(level_picture().size(), cv::Size(1200, 900));
}

TEST(DrawRangeMap, ColoursFollowTheDepthFromLeftToRight) {
  const cv::Mat3b picture = range_map_picture(make_plane(0.7F, 0));
  for (const double x : {0.02, 0.2, 0.5, 0.8, 0.98}) {
    // The colours leave out 0.5 % at each end, and a pixel of the map is 1 / 64 wide.
    EXPECT_NEAR(place_on_map(picture, x, 0.3), x, 0.03);
  }
}

TEST(DrawRangeMap, ShowsRowZeroAtTheTop) {
  const cv::Mat3b picture = range_map_picture(make_plane(0, 0.7F));
  for (const double y : {0.02, 0.2, 0.5, 0.8, 0.98}) {
    EXPECT_NEAR(place_on_map(picture, 0.3, y), y, 0.03);
  }
}

TEST(DrawRangeMap, ShowsUnknownInGreyAndNothingElse) {
  geometry::RangeMap map = make_plane(1, 0);
  map.z.block(0, 0, kRows / 2, kCols / 4) = kFloatNaN;
  const cv::Mat3b picture = range_map_picture(map);
  const cv::Mat1b grey = mask_of(picture, kUnknownColor, 1, kImage);
  EXPECT_NEAR(cv::countNonZero(grey), kImage.area() / 8.0, 0.01 * kImage.area());
  EXPECT_NEAR(center_of(grey).x() / kImage.width, 1 / 8.0, 0.01);
  EXPECT_NEAR(center_of(grey).y() / kImage.height, 1 / 4.0, 0.01);
}

TEST(DrawRangeMap, IsNotSpoiltByAFewWrongPixels) {
  geometry::RangeMap map = make_plane(1, 0);
  map.z(5, 60) = 1e5F;
  map.z(6, 3) = 0.1F;
  EXPECT_NEAR(place_on_map(range_map_picture(map), 0.5, 0.7), 0.5, 0.03);
}

TEST(DrawRangeMap, ViewAndColoursAreThoseOfAnObjectBeforeAWall) {
  // A ramp of 12 x 9 pixels from 700 mm, far before a wall.
  geometry::RangeMap map = make_plane(0, 0);
  map.z.setConstant(900);
  for (int col = 0; col < 12; ++col)
    map.z.block(20, 30 + col, 9, 1).setConstant(700 + 5 * static_cast<float>(col));
  const cv::Mat3b picture = range_map_picture(map);
  // The ramp takes most of the picture, and all colours.
  const cv::Mat1b wall = mask_of(picture, color_at(ColorMap::sequential, 1), 1, kImage);
  EXPECT_LT(cv::countNonZero(wall), kImage.area() / 2);
  EXPECT_LT(place_on_map(picture, 0.2, 0.5), 0.1);
  EXPECT_NEAR(place_on_map(picture, 0.5, 0.5), 0.5, 0.1);
  // The wall is beyond the scale, which says so.
  const Region mark(1038, 80, 60, 60);
  EXPECT_GT(cv::countNonZero(mask_of(picture, {40, 40, 40}, 60, mark)), 20);
  EXPECT_EQ(cv::countNonZero(mask_of(level_picture(), {40, 40, 40}, 60, mark)), 0);
}

TEST(DrawRangeMap, DrawsAMapAtOneDepthAndOneOfOnePixel) {
  EXPECT_NEAR(place_on_map(level_picture(), 0.5, 0.5), 0.5, 0.01);
  geometry::RangeMap point;
  point.z.setConstant(1, 1, 812.3F);
  EXPECT_NEAR(place_on_map(range_map_picture(point), 0.5, 0.5), 0.5, 0.01);
}

TEST(DrawRangeMap, PutsTheTitleAboveTheImage) {
  const auto dark = [](const std::string& title) {
    const cv::Mat3b picture = draw_picture(
        [&](const std::filesystem::path& png) { draw_range_map(png, make_plane(1, 0), title); });
    return mask_of(picture, {0, 0, 0}, 200, {0, 10, 1200, 44});
  };
  EXPECT_EQ(cv::countNonZero(dark("")), 0);
  EXPECT_GT(cv::countNonZero(dark("Range map")), 200);
  // One that is much too long is made smaller, not cut off.
  const cv::Mat1b mask = dark(std::string(300, 'x'));
  EXPECT_EQ(cv::countNonZero(mask.colRange(0, 10)) + cv::countNonZero(mask.colRange(1190, 1200)),
            0);
  EXPECT_GT(cv::countNonZero(mask.colRange(100, 200)), 0);
}

TEST(DrawRangeMap, TakesTitlesWithUnusualCharacters) {
  for (const char* title :
       {"50 % of $a$", "a | b", "Ente \u00e4\u00b5", "two\nlines", "\xff\xfe"}) {
    EXPECT_EQ(draw_picture([&](const std::filesystem::path& png) {
                draw_range_map(png, make_plane(1, 0), title);
              }).size(),
              cv::Size(1200, 900));
  }
}

TEST(DrawRangeMap, RefusesMapsWithoutDepths) {
  geometry::RangeMap map;
  const auto attempt = [&map](const std::filesystem::path& png) { draw_range_map(png, map, ""); };
  expect_refused(attempt, "range map: is empty");
  map.z.setConstant(kRows, kCols, kFloatNaN);
  expect_refused(attempt, "range map: holds no finite value");
}

TEST(DrawRangeMap, GivesTheSameBytesAgain) {
  expect_same_again(
      [](const std::filesystem::path& png) { draw_range_map(png, make_plane(1, 0), "Again"); });
}

TEST(DrawRangeMap, SaysWhenItCannotWrite) {
  expect_unwritable(
      [](const std::filesystem::path& png) { draw_range_map(png, make_plane(1, 0), ""); });
}

}  // namespace
}  // namespace palpate::pictures
