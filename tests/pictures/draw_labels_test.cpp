// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_labels.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

const std::vector<std::string> kNames = {"one",   "two",   "three", "four", "five",   "six",
                                         "seven", "eight", "nine",  "ten",  "eleven", "twelve"};

cv::Mat3b labels_picture(const LabelImage& labels, const std::vector<std::string>& names = kNames) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_labels(png, labels, names, "Labels"); });
}

/// The place of an image of 12 x 9 px on the picture.
cv::Point place_of(int row, int col) {
  constexpr int kPixel = 70;  // 840 px of room for 12
  return {30 + col * kPixel + kPixel / 2, 480 + (row - 4) * kPixel};
}

TEST(DrawLabels, GivesEachLabelAColourOfItsOwnInItsPlace) {
  LabelImage labels = LabelImage::Zero(9, 12);
  for (int label = 0; label < 12; ++label)
    labels(label % 2 == 0 ? 1 : 7, label) = static_cast<std::uint8_t>(label);
  const cv::Mat3b picture = labels_picture(labels);
  EXPECT_EQ(picture.size(), cv::Size(1200, 900));
  std::set<Rgb> colors;
  for (int label = 0; label < 12; ++label) {
    const cv::Point at = place_of(label % 2 == 0 ? 1 : 7, label);
    const Rgb color = pixel(picture, at.x, at.y);
    EXPECT_TRUE(colors.insert(color).second) << label;
    if (label == 0) continue;
    // A field of the image, and the same colour in the legend.
    const cv::Mat1b field = mask_of(picture, color, 2, {0, 60, 880, 840});
    const cv::Mat1b legend = mask_of(picture, color, 2, {890, 60, 310, 840});
    EXPECT_NEAR(cv::countNonZero(field), 70 * 70, 300) << label;
    EXPECT_GT(cv::countNonZero(legend), 20 * 20) << label;
  }
  EXPECT_EQ(*colors.begin() == *colors.rbegin(), false);
}

TEST(DrawLabels, TheLegendDoesNotChangeWithTheImage) {
  const cv::Mat3b empty = labels_picture(LabelImage::Zero(9, 12), {"good", "bad"});
  const cv::Mat3b full = labels_picture(LabelImage::Constant(9, 12, 1), {"good", "bad"});
  const Rgb bad = pixel(full, place_of(4, 5).x, place_of(4, 5).y);
  const Region legend{890, 60, 310, 840};
  EXPECT_GT(cv::countNonZero(mask_of(empty, bad, 2, legend)), 20 * 20);
  EXPECT_GT(cv::countNonZero(mask_of(full, bad, 2, legend)), 20 * 20);
}

TEST(DrawLabels, RefusesWhatItCannotName) {
  const auto refused = [](const LabelImage& labels, const std::vector<std::string>& names,
                          const std::string& words) {
    expect_refused([&](const std::filesystem::path& png) { draw_labels(png, labels, names, ""); },
                   words);
  };
  refused(LabelImage(0, 0), kNames, "the image is empty");
  refused(LabelImage::Constant(3, 3, 2), {"one", "two"}, "a label 2, but only 2 names");
  refused(LabelImage::Zero(3, 3), {}, "0 names");
  refused(LabelImage::Zero(3, 3), std::vector<std::string>(13, "x"), "13 names");
}

TEST(DrawLabels, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) {
    draw_labels(png, LabelImage::Zero(3, 3), kNames, "");
  });
}

}  // namespace
}  // namespace palpate::pictures
