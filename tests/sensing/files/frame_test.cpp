// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/frame.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

cv::Mat ramp_image(int type) {
  cv::Mat image(40, 60, type);
  cv::randu(image, 0, image.depth() == CV_8U ? 255 : 65535);
  return image;
}

TEST(Frame, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    for (const char* name : {"frame.png", "frame.tiff"}) {
      const cv::Mat image = ramp_image(type);
      cv::imwrite((folder / name).string(), image);
      const cv::Mat again = read_frame(folder / name);
      ASSERT_EQ(again.type(), type) << name;
      EXPECT_EQ(cv::norm(image, again, cv::NORM_INF), 0) << name;
    }
  }
}

TEST(Frame, ReadsBmpAndWebpWithoutLossesAndJpegWithItsLosses) {
  const ScratchFolder folder;
  cv::Mat smooth(40, 60, CV_8UC3);
  for (int v = 0; v < smooth.rows; ++v) {
    for (int u = 0; u < smooth.cols; ++u)
      smooth.at<cv::Vec3b>(v, u) =
          cv::Vec3b(static_cast<uchar>(4 * u), static_cast<uchar>(5 * v), 90);
  }
  for (const char* name : {"frame.bmp", "frame.webp"}) {  // above 100 OpenCV writes lossless files
    cv::imwrite((folder / name).string(), smooth, {cv::IMWRITE_WEBP_QUALITY, 101});
    EXPECT_EQ(cv::norm(read_frame(folder / name), smooth, cv::NORM_INF), 0) << name;
    EXPECT_FALSE(has_losses(folder / name)) << name;
    EXPECT_TRUE(has_frame_name(folder / name)) << name;
  }
  cv::Mat grey;
  cv::extractChannel(smooth, grey, 0);
  for (const char* name : {"frame.JPG", "frame.webp"}) {
    cv::imwrite((folder / name).string(), smooth, {cv::IMWRITE_WEBP_QUALITY, 90});
    EXPECT_LT(cv::norm(read_frame(folder / name), smooth, cv::NORM_INF), 30) << name;
    EXPECT_TRUE(has_losses(folder / name)) << name;
    EXPECT_TRUE(has_frame_name(folder / name)) << name;
  }
  cv::imwrite((folder / "grey.jpg").string(), grey);
  EXPECT_EQ(read_frame(folder / "grey.jpg").type(), CV_8UC1);
  EXPECT_FALSE(has_frame_name("frame.gif"));
}

TEST(Frame, IsNotTurnedByTheNoteOfAPhone) {
  const ScratchFolder folder;
  cv::imwrite((folder / "flat.jpg").string(), ramp_image(CV_8UC1));
  std::string bytes = read_text(folder / "flat.jpg");
  // An EXIF segment with one entry: orientation 6, a quarter turn.
  using namespace std::string_literals;
  const std::string exif =
      "\xFF\xE1\x00\x22"
      "Exif\0\0"
      "MM\0*\0\0\0\x08"
      "\0\x01"
      "\x01\x12\0\x03\0\0\0\x01\0\x06\0\0"
      "\0\0\0\0"s;
  bytes.insert(2, exif);
  const cv::Mat upright = cv::imread(written(folder, "turned.jpg", bytes).string());
  ASSERT_EQ(upright.cols, 40);  // OpenCV itself would turn it
  EXPECT_EQ(read_frame(folder / "turned.jpg").cols, 60);
}

TEST(Frame, RefusesTruncatedFilesOfEveryLengthInSilence) {
  const ScratchFolder folder;
  for (const char* name : {"frame.png", "frame.tiff", "frame.bmp", "frame.jpg", "frame.webp"}) {
    cv::imwrite((folder / name).string(), ramp_image(CV_8UC3));
    const std::string bytes = read_text(folder / name);
    ::testing::internal::CaptureStderr();
    for (std::size_t length = 0; length < bytes.size(); length += 97) {
      EXPECT_THROW((void)read_frame(written(folder, "cut.bin", bytes.substr(0, length))), FileError)
          << name << " cut to " << length << " of " << bytes.size();
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << name;
  }
}

TEST(Frame, IsWrittenAsItIs) {
  const ScratchFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    const cv::Mat image = ramp_image(type);
    write_png(folder / "frame.png", image);
    const cv::Mat read = read_frame(folder / "frame.png");
    ASSERT_EQ(read.type(), type);
    EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0);
  }
  EXPECT_THROW(write_png(folder / "frame.png", cv::Mat(3, 3, CV_32FC1)), InvalidInput);
  EXPECT_THROW(write_png(folder / "frame.png", cv::Mat()), InvalidInput);
}

TEST(Frame, RefusesADamagedFile) {
  const ScratchFolder folder;
  cv::imwrite((folder / "frame.png").string(), ramp_image(CV_8UC3));
  std::string bytes = read_text(folder / "frame.png");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  const auto path = written(folder, "damaged.png", bytes);
  const std::string message = message_of<FileError>([&] { (void)read_frame(path); });
  EXPECT_EQ(message.find(path.string() + ": is damaged before byte "), 0) << message;
}

TEST(Frame, RefusesMissingEmptyAndForeignFiles) {
  const ScratchFolder folder;
  EXPECT_THROW((void)read_frame(folder / "none.png"), FileError);
  EXPECT_THROW((void)read_frame(folder.path()), FileError);
  const auto empty = written(folder, "empty.png", "");
  EXPECT_EQ(message_of<FileError>([&] { (void)read_frame(empty); }), empty.string() + ": is empty");
  EXPECT_THROW((void)read_frame(demo_path("rig.yaml")), FileError);
  EXPECT_THROW((void)read_frame(demo_path("truth/duck.tiff")), FileError);  // floating point
}

}  // namespace
}  // namespace palpate::sensing
