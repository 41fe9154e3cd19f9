// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_distances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Left of the scale, above the scale bar and the axes.
const Region kDistancesScene(0, 90, 1000, 690);

/// Two triangles with distances of opposite sign.
const geometry::TriangleMesh kSquare = make_square({-50, -50, 700}, 100, 1);

cv::Mat3b distances_picture(const geometry::TriangleMesh& mesh, const Eigen::VectorXd& distances,
                            double limit) {
  return draw_picture([&](const std::filesystem::path& png) {
    draw_distances(png, mesh, distances, {.title = "Distances", .subtitle = "", .limit = limit});
  });
}

int red(const Rgb& color) { return color[0] - color[2]; }

/// Sum over the scene of how much more red than blue there is.
double redness(const cv::Mat3b& picture) {
  double sum = 0;
  for (int y = kDistancesScene.y; y < kDistancesScene.y + kDistancesScene.height; ++y) {
    for (int x = kDistancesScene.x; x < kDistancesScene.x + kDistancesScene.width; ++x)
      sum += red(pixel(picture, x, y));
  }
  return sum;
}

TEST(DrawDistances, ShowsPositiveRedAndNegativeBlue) {
  const cv::Mat3b red_one = distances_picture(kSquare, Eigen::Vector2d(0.4, 0.4), 0.5);
  EXPECT_EQ(red_one.size(), cv::Size(1200, 900));
  EXPECT_GT(redness(red_one), 1e6);
  EXPECT_LT(redness(distances_picture(kSquare, Eigen::Vector2d(-0.4, -0.4), 0.5)), -1e6);
  EXPECT_LT(std::abs(redness(distances_picture(kSquare, Eigen::Vector2d(0, 0), 0.5))), 1e5);
}

TEST(DrawDistances, ColoursAreThoseOfTheScale) {
  // Seen almost from the front the shading takes little away.
  const cv::Mat3b picture = distances_picture(kSquare, Eigen::Vector2d(0.25, 0.25), 0.5);
  const Rgb middle = pixel(picture, 505, 450);
  EXPECT_LE(color_distance(middle, color_at(ColorMap::diverging, 0.75)), 40);
}

TEST(DrawDistances, EachTriangleHasItsOwnColour) {
  const cv::Mat3b picture = distances_picture(kSquare, Eigen::Vector2d(0.5, -0.5), 0.5);
  EXPECT_GT(
      cv::countNonZero(mask_of(picture, color_at(ColorMap::diverging, 1), 60, kDistancesScene)),
      kDistancesScene.area() / 20);
  EXPECT_GT(
      cv::countNonZero(mask_of(picture, color_at(ColorMap::diverging, 0), 60, kDistancesScene)),
      kDistancesScene.area() / 20);
}

TEST(DrawDistances, ScaleMarksTheEndsThatValuesLieBeyond) {
  // Right of the surface; the marks stand at the ends of the scale, its numbers right of it.
  const auto marks = [](double one, double other) {
    const cv::Mat3b picture = distances_picture(kSquare, Eigen::Vector2d(one, other), 0.5);
    const auto dark = [&](int y) {
      return cv::countNonZero(mask_of(picture, {40, 40, 40}, 60, {1008, y, 40, 20})) > 10;
    };
    return std::pair(dark(98), dark(840));
  };
  EXPECT_EQ(marks(0.5, -0.5), std::pair(false, false));
  EXPECT_EQ(marks(0.6, -0.5), std::pair(true, false));
  EXPECT_EQ(marks(0.5, -0.6), std::pair(false, true));
  EXPECT_EQ(marks(7, -7), std::pair(true, true));
}

TEST(DrawDistances, RefusesWhatCannotBeShown) {
  Eigen::VectorXd distances = Eigen::Vector2d(1, 2);
  double limit = 1;
  const auto attempt = [&](const std::filesystem::path& png) {
    draw_distances(png, kSquare, distances, {.title = "", .subtitle = "", .limit = limit});
  };
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    limit = bad;
    expect_refused(attempt, "limit");
  }
  limit = 1;
  distances.setConstant(std::nan(""));
  expect_refused(attempt, "distances: holds no finite value");
  distances.resize(3);
  expect_refused(attempt, "distances");
}

TEST(DrawDistances, GivesTheSameBytesAgain) {
  expect_same_again([](const std::filesystem::path& png) {
    draw_distances(png, kSquare, Eigen::Vector2d(1, -1),
                   {.title = "Again", .subtitle = "", .limit = 1});
  });
}

TEST(DrawDistances, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) {
    draw_distances(png, kSquare, Eigen::Vector2d(1, -1), {.title = "", .subtitle = "", .limit = 1});
  });
}

}  // namespace
}  // namespace palpate::pictures
