// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decodable.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "palpate/sensing/frame_source.h"
#include "palpate/sensing/tiff_frame.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

TEST(Decodable, IsWhatTheSourceOfRecordedFramesReads) {
  const ScratchFolder folder;
  cv::Mat mosaic(16, 20, CV_8UC1);
  cv::randu(mosaic, 40, 60);
  mosaic.at<unsigned char>(7, 9) = 255;  // a hot pixel
  write_tiff(folder / "a.tiff", mosaic);
  for (const std::optional<BayerPattern> bayer :
       {std::optional<BayerPattern>(), std::optional(BayerPattern::grbg)}) {
    FrameSource source({folder.path()}, {.bayer = bayer});
    const cv::Mat read = source.next()->read();
    const cv::Mat live = decodable(mosaic, bayer);
    ASSERT_EQ(live.type(), read.type());
    EXPECT_EQ(cv::norm(live, read, cv::NORM_INF), 0);
  }
}

TEST(Decodable, TwelveBitsInSixteenAreStretchedOnRequestAlone) {
  cv::Mat image(4, 4, CV_16UC3, cv::Scalar(0, 2048, 4095));
  EXPECT_EQ(cv::Mat_<cv::Vec3w>(decodable(image, {}))(1, 1), cv::Vec3w(0, 2048, 4095));
  EXPECT_EQ(cv::Mat_<cv::Vec3w>(decodable(image, {}, 12))(1, 1), cv::Vec3w(0, 32776, 65535));
  image.at<cv::Vec3w>(0, 0)[0] = 4096;
  EXPECT_NE(message_of<InvalidInput>([&] { (void)decodable(image, {}, 12); }).find("value 4096"),
            std::string::npos);
  const cv::Mat narrow(4, 4, CV_8UC3, cv::Scalar::all(9));
  EXPECT_EQ(cv::norm(decodable(narrow, {}, 12), narrow, cv::NORM_INF), 0);
}

TEST(Decodable, HotPixelsAreReplacedWhateverTheBitsOfTheMosaic) {
  for (const int bits : {8, 10, 12, 14, 16}) {
    const double full = (1 << bits) - 1;
    cv::Mat mosaic(16, 20, CV_16UC1);
    cv::randu(mosaic, 0.2 * full, 0.22 * full);
    mosaic.at<unsigned short>(7, 9) = static_cast<unsigned short>(0.4 * full);
    double largest = 0;
    cv::minMaxLoc(decodable(mosaic, BayerPattern::rggb, bits).reshape(1), nullptr, &largest);
    EXPECT_LE(largest, 0.22 * 65535 + 1) << bits;
  }
}

TEST(Decodable, AnImageInColourIsNoMosaic) {
  const cv::Mat color(16, 20, CV_8UC3, cv::Scalar::all(9));
  EXPECT_FALSE(
      message_of<InvalidInput>([&] { (void)decodable(color, BayerPattern::rggb); }).empty());
}

}  // namespace
}  // namespace palpate::sensing
