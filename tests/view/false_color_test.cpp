// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "false_color.h"

#include <gtest/gtest.h>

#include "not_finite.h"

namespace palpate::view {
namespace {

pictures::Rgb pixel(const ColorImage& image, int row, int col) {
  const std::size_t at =
      4 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
           static_cast<std::size_t>(col));
  return {image.bytes[at], image.bytes[at + 1], image.bytes[at + 2]};
}

TEST(FalseColor, ShowsEachPixelInItsPlaceWithTheColourOfItsValue) {
  geometry::ImageF image(2, 3);
  image << 0, 5, 10, static_cast<float>(kNaN), -100, static_cast<float>(kInf);
  const ColorSpan span{.map = pictures::ColorMap::sequential, .low = 0, .high = 10};
  const ColorImage colors = color_image(image, span);
  ASSERT_EQ(colors.width, 3);
  ASSERT_EQ(colors.height, 2);
  ASSERT_EQ(colors.bytes.size(), 24u);
  const auto at = [](double part) {
    return pictures::color_at(pictures::ColorMap::sequential, part);
  };
  EXPECT_EQ(pixel(colors, 0, 0), at(0));
  EXPECT_EQ(pixel(colors, 0, 1), at(0.5));
  EXPECT_EQ(pixel(colors, 0, 2), at(1));
  EXPECT_EQ(pixel(colors, 1, 0), pictures::kUnknownColor);
  EXPECT_EQ(pixel(colors, 1, 1), at(0)) << "the nearer end";
  EXPECT_EQ(pixel(colors, 1, 2), pictures::kUnknownColor);
}

TEST(FalseColor, MarksWrongDepthsInBlack) {
  const geometry::ImageF image = geometry::ImageF::Zero(1, 2);
  geometry::PixelMask marked(1, 2);
  marked << false, true;
  const ColorImage colors =
      color_image(image, {.map = pictures::ColorMap::diverging, .low = -1, .high = 1}, marked);
  EXPECT_EQ(pixel(colors, 0, 0), (pictures::Rgb{255, 255, 255})) << "no difference is white";
  EXPECT_EQ(pixel(colors, 0, 1), pictures::kBlack);
}

TEST(FalseColor, GivesEachReasonAColourOfItsOwn) {
  sensing::ReasonImage reasons(1, sensing::kReasonCount);
  for (int code = 0; code < sensing::kReasonCount; ++code)
    reasons(0, code) = static_cast<std::uint8_t>(code);
  const ColorImage colors = color_image(reasons);
  for (int a = 0; a < sensing::kReasonCount; ++a) {
    for (int b = 0; b < a; ++b) EXPECT_NE(pixel(colors, 0, a), pixel(colors, 0, b));
  }
}

TEST(ColorSpan, OfDepthsIsThatOfTheObjectBeforeItsBackground) {
  std::vector<double> depths(1000, 900);  // a wall
  for (int i = 0; i <= 1000; ++i) depths.push_back(500 + 0.05 * i);
  const ColorSpan span = span_of_depths(depths);
  EXPECT_NEAR(span.low, 500, 1);
  EXPECT_NEAR(span.high, 550, 1);
  EXPECT_LT(span_of_depths({}).low, span_of_depths({}).high) << "nothing is known";
  EXPECT_LT(span_of_depths({700}).low, span_of_depths({700}).high);
}

TEST(ColorSpan, OfDeviationsLeavesOutTheLargestOnes) {
  std::vector<double> deviations(1000, 0.1);
  deviations.push_back(50);
  EXPECT_EQ(span_of_deviations(deviations).low, 0);
  EXPECT_EQ(span_of_deviations(deviations).high, 0.1);
}

TEST(ColorSpan, OfDifferencesIsFourTimesTheMedianToBothSides) {
  EXPECT_EQ(span_of_differences({-0.3, 0.1, 0.2}).high, 0.8);
  EXPECT_EQ(span_of_differences({-0.3, 0.1, 0.2}).low, -0.8);
  EXPECT_GT(span_of_differences({0, 0, 0}).high, 0) << "two sequences that are the same";
}

}  // namespace
}  // namespace palpate::view
