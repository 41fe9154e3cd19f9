// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/tiff_frame.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

TEST(TiffFrame, OpenCvReadsWhatIsWrittenForEveryTypeOfFrame) {
  const ScratchFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 5), cv::Size(640, 3)}) {
      cv::Mat image(size, type);
      cv::randu(image, 0, 65536);
      const cv::Mat before = image.clone();
      write_tiff(folder / "a.tiff", image);
      EXPECT_EQ(cv::norm(image, before, cv::NORM_INF), 0);
      const cv::Mat read = cv::imread(folder / "a.tiff", cv::IMREAD_UNCHANGED);
      ASSERT_EQ(read.type(), type);
      EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0) << type << " " << size;
      EXPECT_EQ(cv::norm(read_frame(folder / "a.tiff"), image, cv::NORM_INF), 0);
    }
  }
}

TEST(TiffFrame, APartOfAnImageIsWrittenWithItsOwnRows) {
  const ScratchFolder folder;
  cv::Mat image(20, 30, CV_8UC1);
  cv::randu(image, 0, 256);
  const cv::Mat part = image(cv::Rect(3, 4, 9, 8));
  write_tiff(folder / "a.tiff", part);
  EXPECT_EQ(cv::norm(read_frame(folder / "a.tiff"), part, cv::NORM_INF), 0);
}

TEST(TiffFrame, WhatIsNoFrameIsRefused) {
  const ScratchFolder folder;
  for (const cv::Mat& image : {cv::Mat(), cv::Mat(2, 2, CV_32F), cv::Mat(2, 2, CV_8UC4)}) {
    const std::string message =
        message_of<InvalidInput>([&] { write_tiff(folder / "a.tiff", image); });
    EXPECT_NE(message.find("8 or 16 bit with 1 or 3 channels"), std::string::npos) << message;
  }
  EXPECT_EQ(folder.entries(), 0);
}

}  // namespace
}  // namespace palpate::sensing
