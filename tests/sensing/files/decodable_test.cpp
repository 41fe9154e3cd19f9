// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decodable.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "palpate/error.h"
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

TEST(Decodable, AnImageInColourIsNoMosaic) {
  const cv::Mat color(16, 20, CV_8UC3, cv::Scalar::all(9));
  EXPECT_FALSE(
      message_of<InvalidInput>([&] { (void)decodable(color, BayerPattern::rggb); }).empty());
}

}  // namespace
}  // namespace palpate::sensing
