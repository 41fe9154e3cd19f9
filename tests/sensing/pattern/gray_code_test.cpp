// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/gray_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/structured_light.hpp>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

/// Every panel pixel decodes to itself.
void expect_identity(const cv::Mat_<cv::Vec2f>& places, const cv::Rect& part) {
  for (int row = part.y; row < part.y + part.height; ++row) {
    for (int column = part.x; column < part.x + part.width; ++column) {
      ASSERT_EQ(places(row, column)[0], static_cast<float>(column));
      ASSERT_EQ(places(row, column)[1], static_cast<float>(row));
    }
  }
}

TEST(GrayCode, EveryPixelFindsItself) {
  for (const ImageSize panel : {ImageSize{2, 2}, ImageSize{37, 19}, ImageSize{128, 65}}) {
    const std::vector<cv::Mat> images = draw_gray_code(panel);
    EXPECT_EQ(static_cast<int>(images.size()), gray_code_length(panel));
    expect_identity(decode_gray_code(images, panel), {0, 0, panel.width, panel.height});
  }
}

TEST(GrayCode, IsTheSequenceOfOpenCv) {
  const ImageSize panel{300, 140};
  const std::vector<cv::Mat> images = draw_gray_code(panel);
  std::vector<cv::Mat> peer;
  const auto code = cv::structured_light::GrayCodePattern::create(panel.width, panel.height);
  ASSERT_TRUE(code->generate(peer));
  ASSERT_EQ(images.size(), peer.size() + 2);  // white and black come apart there
  for (std::size_t i = 0; i < peer.size(); ++i)
    EXPECT_EQ(cv::countNonZero(images[i] != peer[i]), 0) << i;
  EXPECT_EQ(cv::countNonZero(images[peer.size()]), panel.width * panel.height);
  EXPECT_EQ(cv::countNonZero(images.back()), 0);
}

TEST(GrayCode, NeighboursDifferInOneBit) {
  const std::vector<cv::Mat> images = draw_gray_code({200, 90});
  for (int column = 1; column < 200; ++column) {
    int differences = 0;
    for (std::size_t i = 0; i + 2 < images.size(); i += 2)
      differences += images[i].at<uchar>(7, column) != images[i].at<uchar>(7, column - 1) ? 1 : 0;
    EXPECT_EQ(differences, 1) << column;
  }
}

TEST(GrayCode, NeitherSurfaceNorRoomLightMatters) {
  const ImageSize panel{64, 48};
  std::vector<cv::Mat> images = draw_gray_code(panel);
  cv::Mat surface(48, 64, CV_32F);
  cv::Mat room(48, 64, CV_32F);
  cv::RNG random(3);
  random.fill(surface, cv::RNG::UNIFORM, 0.05, 0.6);
  random.fill(room, cv::RNG::UNIFORM, 0, 20000);
  for (cv::Mat& image : images) {
    image.convertTo(image, CV_32F, 257);
    image = image.mul(surface) + room;
    image.convertTo(image, CV_16U);
  }
  expect_identity(decode_gray_code(images, panel, {.min_contrast = 0.04}), {0, 0, 64, 48});
}

TEST(GrayCode, DarkPixelsAndCodesBesideThePanelAreUnknown) {
  const ImageSize panel{37, 19};
  std::vector<cv::Mat> images = draw_gray_code(panel);
  const auto pairs = images.size() - 2;
  images[pairs](cv::Rect(0, 0, 37, 4)) = 5;  // hardly brighter than black: a shadow
  const unsigned beyond = 40;                // a code that no column of this panel has
  for (std::size_t bit = 0; bit < 6; ++bit) {
    const bool is_set = (((beyond ^ (beyond >> 1)) >> (5 - bit)) & 1U) != 0;
    images[2 * bit].at<uchar>(10, 20) = is_set ? 255 : 0;
    images[2 * bit + 1].at<uchar>(10, 20) = is_set ? 0 : 255;
  }
  const cv::Mat_<cv::Vec2f> places = decode_gray_code(images, panel);
  EXPECT_TRUE(std::isnan(places(3, 36)[0]) && std::isnan(places(0, 0)[1]));
  EXPECT_TRUE(std::isnan(places(10, 20)[0]));
  expect_identity(places, {0, 4, 37, 6});
}

TEST(GrayCode, RefusesAPanelOfExchangedWidthAndHeight) {
  const ImageSize panel{60, 40};  // as many bits for either
  const std::vector<cv::Mat> images = draw_gray_code(panel);
  const std::string message = message_of<InvalidInput>([&] {
    (void)decode_gray_code(images, {40, 60});
  });
  EXPECT_NE(message.find("33 % of the lit pixels"), std::string::npos) << message;
  EXPECT_NE(message.find("40 x 60 px (width x height)"), std::string::npos) << message;
}

TEST(GrayCode, RefusesWrongInput) {
  EXPECT_THROW((void)draw_gray_code({1, 10}), InvalidInput);
  EXPECT_THROW((void)draw_gray_code({10, 1 << 16}), InvalidInput);
  const ImageSize panel{16, 16};
  std::vector<cv::Mat> images = draw_gray_code(panel);
  EXPECT_THROW((void)decode_gray_code(images, panel, {.min_contrast = std::nan("")}), InvalidInput);
  EXPECT_THROW((void)decode_gray_code(images, {32, 16}), InvalidInput);
  images[3] = cv::Mat(16, 15, CV_8U, cv::Scalar(0));
  EXPECT_THROW((void)decode_gray_code(images, panel), InvalidInput);
  images[3] = cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(0));
  EXPECT_THROW((void)decode_gray_code(images, panel), InvalidInput);
  EXPECT_THROW((void)decode_gray_code({}, panel), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
