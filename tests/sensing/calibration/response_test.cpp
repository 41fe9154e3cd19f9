// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using Curve = std::function<double(double)>;
using ::testing::HasSubstr;

/// A bright wall on the left, lit unevenly, and a dark corner on the right; 8 or 16 bit with noise.
cv::Mat see(double level, const Curve& curve, int depth, double noise, int channels = 1) {
  cv::Mat image(60, 80, CV_MAKETYPE(CV_32F, channels));
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const double albedo = column < 60 ? 0.7 + 0.004 * column : 0.02;
      for (int c = 0; c < channels; ++c)
        image.ptr<float>(row)[column * channels + c] =
            static_cast<float>(0.03 + 0.8 * albedo * curve(level));
    }
  }
  cv::RNG random(static_cast<std::uint64_t>(level * 1e6) + 1);
  cv::Mat grain(image.size(), image.type());
  random.fill(grain, cv::RNG::NORMAL, 0, noise);
  image += grain;
  const double full = depth == CV_8U ? 255 : 65535;
  image.convertTo(image, depth, full);
  return image;
}

std::vector<GreyImage> make_ramp(const Curve& curve, int depth = CV_16U, double noise = 0,
                                 int channels = 1) {
  std::vector<GreyImage> ramp;
  for (int level = 0; level <= 255; level += 15) {
    ramp.push_back({level / 255.0, see(level / 255.0, curve, depth, noise, channels),
                    "grey_" + std::to_string(level)});
  }
  return ramp;
}

Curve power(double gamma) {
  return [gamma](double level) { return std::pow(level, gamma); };
}

TEST(Response, FindsTheExponentThroughNoise) {
  for (const double gamma : {0.6, 1.0, 2.2}) {
    const Response response = calibrate_response(make_ramp(power(gamma), CV_8U, 0.01));
    ASSERT_EQ(response.channels.size(), 1U);
    const ResponseCurve& curve = response.channels[0];
    EXPECT_NEAR(curve.gamma, gamma, 0.01);
    EXPECT_NEAR(curve.black, 0.03, 0.002);
    EXPECT_NEAR(curve.gain, 0.8 * (0.7 + 0.004 * 29.5), 0.003);
    EXPECT_LT(curve.misfit, 0.002);
    EXPECT_LT(std::abs(curve.gamma - gamma), 5 * curve.gamma_deviation + 1e-4);
  }
}

TEST(Response, LinearizingUndoesTheResponse) {
  // No power law: a toe and a shoulder.
  const Curve bent = [](double level) {
    return 0.3 * level + 0.7 * level * level * (3 - 2 * level);
  };
  for (const Curve& curve : {power(2.2), power(0.7), bent}) {
    const Response response = calibrate_response(make_ramp(curve));
    const double full = linearize(cv::Mat(1, 1, CV_16U, cv::Scalar(65535)), response).at<ushort>(0);
    EXPECT_EQ(full, 65535);
    double scale = 0;
    for (const double level : {1.0, 0.8, 0.5, 0.31, 0.13, 0.05}) {
      // The mean surface of the ramp.
      const double value = 0.03 + 0.8 * (0.7 + 0.004 * 29.5) * curve(level);
      const cv::Mat seen(1, 1, CV_16U, cv::Scalar(std::round(65535 * value)));
      const double linear = linearize(seen, response).at<ushort>(0);
      if (level == 1) scale = linear;
      EXPECT_NEAR(linear / scale, level, 0.004) << level;
    }
  }
}

TEST(Response, APowerLawIsUndoneOnEverySurface) {
  const Response response = calibrate_response(make_ramp(power(2.2)));
  // Half as bright as the ramp's surface, and a fifth brighter.
  for (const double albedo : {0.4, 0.98}) {
    const auto linear = [&](double level) {
      const double value = 0.03 + 0.8 * albedo * std::pow(level, 2.2);
      const cv::Mat seen(1, 1, CV_16U, cv::Scalar(std::round(65535 * value)));
      return static_cast<double>(linearize(seen, response).at<ushort>(0));
    };
    EXPECT_NEAR(linear(0.3) / linear(0.9), 1.0 / 3, 0.003) << albedo;
  }
}

TEST(Response, LinearizedFramesRiseAndKeepBlackAndFullScale) {
  const Response response = calibrate_response(make_ramp(power(1.8), CV_8U, 0.003));
  cv::Mat values(1, 256, CV_8U);
  for (int i = 0; i < 256; ++i) values.at<uchar>(i) = static_cast<uchar>(i);
  const cv::Mat linear = linearize(values, response);
  EXPECT_EQ(linear.type(), CV_16UC1);
  EXPECT_EQ(linear.at<ushort>(0), 0);
  EXPECT_EQ(linear.at<ushort>(255), 65535);
  for (int i = 1; i < 256; ++i) EXPECT_GE(linear.at<ushort>(i), linear.at<ushort>(i - 1)) << i;
  // 8 and 16 bit of the same light give the same.
  cv::Mat wide;
  values.convertTo(wide, CV_16U, 257);
  const cv::Mat again = linearize(wide, response);
  for (int i = 0; i < 256; ++i) EXPECT_EQ(again.at<ushort>(i), linear.at<ushort>(i)) << i;
}

TEST(Response, EachChannelHasItsOwnCurve) {
  std::vector<GreyImage> ramp = make_ramp(power(1), CV_16U, 0, 3);
  const double gammas[] = {1.5, 2.0, 2.5};  // blue, green, red
  for (GreyImage& grey : ramp) {
    for (int c = 0; c < 3; ++c)
      cv::insertChannel(see(grey.level, power(gammas[c]), CV_16U, 0), grey.image, c);
  }
  const Response response = calibrate_response(ramp);
  ASSERT_EQ(response.channels.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(response.channels[c].gamma, gammas[c], 0.005);
  const cv::Mat frame(2, 2, CV_16UC3, cv::Scalar(20000, 20000, 20000));
  const auto pixel = linearize(frame, response).at<cv::Vec<ushort, 3>>(0, 0);
  EXPECT_LT(pixel[0], pixel[1]);
  EXPECT_LT(pixel[1], pixel[2]);
}

TEST(Response, ClippedPixelsAndLevelsDoNotCount) {
  // A shiny part of the wall clips early: left out.
  std::vector<GreyImage> ramp = make_ramp(power(2.2));
  for (GreyImage& grey : ramp) {
    cv::Mat part = grey.image(cv::Rect(0, 0, 20, 60));
    part *= 3;
  }
  EXPECT_NEAR(calibrate_response(ramp).channels[0].gamma, 2.2, 0.01);
  // All of it clips at the brightest levels: these are left out.
  for (GreyImage& grey : ramp) grey.image *= 2;
  const ResponseCurve curve = calibrate_response(ramp).channels[0];
  EXPECT_NEAR(curve.gamma, 2.2, 0.02);
  EXPECT_LT(curve.levels.back(), 0.95);
  EXPECT_EQ(curve.light.back(), 1);
}

TEST(Response, OrderOfTheImagesDoesNotMatterAndBlackMayBeMissing) {
  std::vector<GreyImage> ramp = make_ramp(power(2.2));
  const ResponseCurve curve = calibrate_response(ramp).channels[0];
  std::reverse(ramp.begin(), ramp.end());
  EXPECT_EQ(calibrate_response(ramp).channels[0].gamma, curve.gamma);
  ramp.pop_back();  // level 0
  const ResponseCurve without = calibrate_response(ramp).channels[0];
  EXPECT_NEAR(without.black, 0.03, 0.002);
  EXPECT_NEAR(without.gamma, 2.2, 0.01);
  EXPECT_EQ(without.levels.front(), 0);
}

TEST(Response, RefusesRampsThatTellNothing) {
  const auto refusal = [](std::vector<GreyImage> ramp) {
    return message_of<InvalidInput>([&] { (void)calibrate_response(ramp); });
  };
  const std::vector<GreyImage> good = make_ramp(power(2.2));
  EXPECT_NE(refusal({}).find("no images"), std::string::npos);
  EXPECT_NE(refusal({good.begin(), good.begin() + 4}).find("too few, 4"), std::string::npos);
  EXPECT_NE(refusal(make_ramp([](double) { return 0.0; })).find("does not arrive"),
            std::string::npos);
  std::vector<GreyImage> wrong = good;
  std::swap(wrong[7].image, wrong[12].image);
  EXPECT_NE(refusal(wrong).find("grey_120: looks darker than grey_105"), std::string::npos)
      << refusal(wrong);
  wrong = good;
  wrong[3].image = wrong[3].image(cv::Rect(0, 0, 30, 30)).clone();
  EXPECT_NE(refusal(wrong).find("grey_45: differs from"), std::string::npos);
  wrong = good;
  wrong[3].level = wrong[4].level;
  EXPECT_NE(refusal(wrong).find("same level"), std::string::npos);
  wrong[3].level = std::nan("");
  EXPECT_NE(refusal(wrong).find("[0, 1]"), std::string::npos);
  wrong = good;
  for (GreyImage& grey : wrong) grey.image *= 60;
  EXPECT_NE(refusal(wrong).find("clipped"), std::string::npos) << refusal(wrong);
  EXPECT_THROW((void)calibrate_response(good, {.min_range = std::nan("")}), InvalidInput);
}

TEST(Response, SurvivesWritingAndReadingExactly) {
  const ScratchFolder folder;
  const Response response = calibrate_response(make_ramp(power(2.2), CV_8U, 0.01, 3));
  write_response(folder / "response.yaml", response);
  const Response again = read_response(folder / "response.yaml");
  ASSERT_EQ(again.channels.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(again.channels[c].black, response.channels[c].black);
    EXPECT_EQ(again.channels[c].gamma, response.channels[c].gamma);
    EXPECT_EQ(again.channels[c].levels, response.channels[c].levels);
    EXPECT_EQ(again.channels[c].light, response.channels[c].light);
  }
}

TEST(Response, ReadsTheRampOfAFolder) {
  const ScratchFolder folder;
  write_png(folder / "grey_000.png", see(0, power(1), CV_8U, 0));
  write_png(folder / "grey_051.png", see(0.2, power(1), CV_8U, 0));
  write_png(folder / "white_flat.png", see(1, power(1), CV_8U, 0));
  write_png(folder / "grey_300.png", see(1, power(1), CV_8U, 0));
  const std::vector<GreyImage> ramp = read_grey_ramp(folder.path());
  ASSERT_EQ(ramp.size(), 2U);
  EXPECT_EQ(ramp[0].level + ramp[1].level, 0.2);
  EXPECT_THROW((void)read_grey_ramp(folder / "none"), FileError);
  const ScratchFolder empty;
  EXPECT_THROW((void)read_grey_ramp(empty.path()), FileError);
}

TEST(Response, RefusesFilesAndFramesThatDoNotFit) {
  const ScratchFolder folder;
  const std::string good =
      "%YAML:1.0\n---\nresponse:\n   - { black: 0.1, gain: 0.5, gamma: 2., gamma_deviation: 0.1, "
      "misfit: 0.,\n       levels: [ 0., 0.5, 1. ], light: [ 0., 0.25, 1. ] }\n";
  const Response response = read_response(written(folder, "r.yaml", good));
  const auto refusal_of = [&](const std::string& from, const std::string& to) {
    const auto path = written(folder, "r.yaml", replaced(good, from, to));
    return message_of<FileError>([&] { (void)read_response(path); });
  };
  EXPECT_THAT(refusal_of("gain: 0.5", "gain: -0.5"), HasSubstr("gain"));
  EXPECT_THAT(refusal_of("gain: 0.5", "gain: .NaN"), HasSubstr("gain"));
  EXPECT_THAT(refusal_of("0.25, 1.", "0.25"), HasSubstr("as many of each"));
  EXPECT_THAT(refusal_of("0., 0.25, 1.", "0., 1.25, 1."), HasSubstr("light must not fall"));
  EXPECT_THAT(refusal_of("0., 0.5, 1.", "0., 0.5, 0.5"), HasSubstr("levels must rise"));
  EXPECT_THAT(refusal_of("black: 0.1,", ""), HasSubstr("black"));
  EXPECT_THROW((void)linearize(cv::Mat(2, 2, CV_8UC3), response), InvalidInput);
  EXPECT_THROW((void)linearize(cv::Mat(2, 2, CV_32F), response), InvalidInput);
  EXPECT_THROW((void)linearize({}, response), InvalidInput);
  EXPECT_THROW((void)linearize(cv::Mat(2, 2, CV_8U), {}), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
