// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/trained_colors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;

/// A bright image whose red channel leads; `tilt` > 0 leans to yellow, < 0 to magenta. The hue is
/// pi / 3 * tilt for |tilt| <= 1.
cv::Mat reddish(const std::vector<double>& tilts) {
  cv::Mat image(10, 100, CV_16UC3);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const double tilt = tilts[static_cast<std::size_t>(column) % tilts.size()];
      image.at<cv::Vec<ushort, 3>>(row, column) = {
          static_cast<ushort>(std::lround(50000 * std::max(-tilt, 0.0))),
          static_cast<ushort>(std::lround(50000 * std::max(tilt, 0.0))), 50000};
    }
  }
  return image;
}

TEST(TrainedColors, MeanAndVarianceAreCircular) {
  // Hues on both sides of the wrap at red: mean 0.01 pi / 3, variance (0.03 pi / 3)^2.
  const TrainedColors colors = train_colors({{"R", {reddish({-0.02, 0.04})}}});
  ASSERT_EQ(colors.colors.size(), 1U);
  constexpr double kRounding = 1e-4;  // 16 bit values, float hues
  EXPECT_NEAR(colors.colors[0].mean, 0.01 * std::numbers::pi / 3, kRounding);
  EXPECT_NEAR(colors.colors[0].variance, std::pow(0.03 * std::numbers::pi / 3, 2),
              1e-2 * std::pow(0.03 * std::numbers::pi / 3, 2));
  EXPECT_EQ(colors.colors[0].pixels, 1000);
}

TEST(TrainedColors, SeveralImagesOfOneNameCountTogether) {
  const TrainedColors colors =
      train_colors({{"R", {reddish({0.1}), reddish({0.3})}}, {"X", {reddish({-0.5})}}});
  ASSERT_EQ(colors.colors.size(), 2U);
  EXPECT_NEAR(colors.colors[0].mean, 0.2 * std::numbers::pi / 3, 1e-4);
  EXPECT_NEAR(colors.colors[1].mean, 2 * std::numbers::pi - 0.5 * std::numbers::pi / 3, 1e-4);
  EXPECT_EQ(colors.colors[0].pixels, 2000);
}

TEST(TrainedColors, DarkGreyAndClippedPixelsDoNotCount) {
  cv::Mat image = reddish({0.2});
  image.rowRange(0, 2) = cv::Scalar(0, 3000, 3000);        // dark yellow
  image.rowRange(2, 4) = cv::Scalar(40000, 41000, 40000);  // nearly grey
  image.rowRange(4, 6) = cv::Scalar(0, 65535, 65535);      // clipped
  const TrainedColors colors = train_colors({{"R", {image}}});
  EXPECT_EQ(colors.colors[0].pixels, 400);
  EXPECT_NEAR(colors.colors[0].mean, 0.2 * std::numbers::pi / 3, 1e-4);
}

TEST(TrainedColors, BundledColoursLieNearTheirNominalHues) {
  const TrainedColors colors = train_colors_from_folder(demo_path("training"));
  ASSERT_EQ(colors.colors.size(), 6U);
  constexpr std::array<const char*, 6> kNames = {"R", "Y", "G", "C", "B", "M"};
  for (const TrainedColor& color : colors.colors) {
    std::size_t sector = 0;
    while (color.name != kNames.at(sector)) ++sector;
    const double difference = color.mean - static_cast<double>(sector) * std::numbers::pi / 3;
    EXPECT_LT(std::abs(std::remainder(difference, 2 * std::numbers::pi)), std::numbers::pi / 6)
        << color.name;
    EXPECT_LT(color.variance, 0.1) << color.name;
  }
}

TEST(TrainedColors, SurviveWritingAndReadingExactly) {
  const ScratchFolder folder;
  const TrainedColors colors{{{"R", 1.0 / 3, 1e-3 / 7, 12345}, {"dark blue", 4.1, 0, 100}}};
  write_trained_colors(folder / "colors.yaml", colors);
  const TrainedColors again = read_trained_colors(folder / "colors.yaml");
  ASSERT_EQ(again.colors.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.colors[i].name, colors.colors[i].name);
    EXPECT_EQ(again.colors[i].mean, colors.colors[i].mean);
    EXPECT_EQ(again.colors[i].variance, colors.colors[i].variance);
    EXPECT_EQ(again.colors[i].pixels, colors.colors[i].pixels);
  }
}

TEST(TrainedColors, FoldersCountTogetherAndOtherFilesAreLeftOut) {
  const ScratchFolder first;
  const ScratchFolder second;
  write_png(first / "R_flat.png", reddish({0.1}));
  write_png(first / "white_flat.png", reddish({0.9}));
  write_png(first / "projector_off.png", reddish({0.9}));
  write_text(first / "R_notes.txt", "not an image");
  write_png(second / "R_sin.png", reddish({0.3}));
  const TrainedColors colors = train_colors_from_folders({first.path(), second.path()});
  ASSERT_EQ(colors.colors.size(), 1U);
  EXPECT_EQ(colors.colors[0].name, "R");
  EXPECT_NEAR(colors.colors[0].mean, 0.2 * std::numbers::pi / 3, 1e-4);
}

TEST(TrainedColors, RefuseWrongInput) {
  const ScratchFolder folder;
  const cv::Mat dark(50, 50, CV_8UC3, cv::Scalar(0, 0, 3));
  EXPECT_THROW((void)train_colors({}), InvalidInput);
  EXPECT_NE(message_of<InvalidInput>([&] {
              (void)train_colors({{"R", {dark}}});
            }).find("colour R"),
            std::string::npos);
  EXPECT_THROW((void)train_colors({{"R", {cv::Mat(50, 50, CV_8UC1)}}}), InvalidInput);
  EXPECT_THROW((void)train_colors({{"R", {reddish({0.1})}}}, {.min_value = std::nan("")}),
               InvalidInput);
  EXPECT_THROW((void)train_colors({{"R", {reddish({0.1})}}}, {.min_saturation = -1}), InvalidInput);
  EXPECT_THROW((void)train_colors_from_folder(folder / "none"), FileError);
  EXPECT_THROW((void)train_colors_from_folder(folder.path()), FileError);
  written(folder, "R_flat.png", "no image");
  EXPECT_THROW((void)train_colors_from_folder(folder.path()), FileError);
}

TEST(TrainedColors, RefuseWrongFiles) {
  const ScratchFolder folder;
  const auto refusal_of = [&](const std::string& colors) {
    const auto path = written(folder, "c.yaml", "%YAML:1.0\n---\ncolors:\n" + colors);
    return message_of<FileError>([&] { (void)read_trained_colors(path); });
  };
  EXPECT_EQ(refusal_of("   - { name: R, mean: 0.1, variance: 0.1, pixels: 10 }\n"), "");
  EXPECT_THAT(refusal_of("   - { name: R, mean: .NaN, variance: 0.1, pixels: 10 }\n"),
              HasSubstr("colors[0].mean"));
  EXPECT_THAT(refusal_of("   - { name: R, mean: 0.1, variance: -0.1, pixels: 10 }\n"),
              HasSubstr("colors[0].variance: must be >= 0"));
  EXPECT_THAT(refusal_of("   - { name: R, mean: 0.1, variance: 0.1 }\n"), HasSubstr("pixels"));
  EXPECT_THAT(refusal_of("   - { name: R, mean: 0.1, variance: 0.1, pixels: 10 }\n"
                         "   - { name: R, mean: 0.1, variance: 0.1, pixels: 10 }\n"),
              HasSubstr("appears twice"));
  EXPECT_THROW((void)read_trained_colors(folder / "none.yaml"), FileError);
}

}  // namespace
}  // namespace palpate::sensing
