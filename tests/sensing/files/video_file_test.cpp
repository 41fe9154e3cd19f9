// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/video_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

constexpr int kFrames = 5;

/// Noise that shows the number of the frame.
cv::Mat numbered_frame(int number) {
  cv::Mat frame(48, 64, CV_8UC3);
  cv::RNG random(static_cast<std::uint64_t>(number) + 1);
  random.fill(frame, cv::RNG::UNIFORM, 0, 256);
  return frame;
}

/// False if this build of FFmpeg has no such encoder.
bool write_numbered_video(const std::filesystem::path& path, const std::string& codec) {
  cv::VideoWriter writer(path.string(), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), 25,
                         {64, 48});
  if (!writer.isOpened()) return false;
  for (int i = 0; i < kFrames; ++i) writer.write(numbered_frame(i));
  return true;
}

TEST(VideoFile, IsToldByItsEnding) {
  EXPECT_TRUE(is_video("folder.png/wave.MKV"));
  EXPECT_TRUE(is_video("wave.avi"));
  EXPECT_FALSE(is_video("wave.avi.png"));
  EXPECT_FALSE(is_video("avi"));
}

TEST(VideoFile, GivesTheFramesOfALosslessVideoToTheLastBit) {
  const ScratchFolder folder;
  if (!write_numbered_video(folder / "wave.avi", "HFYU"))
    GTEST_SKIP() << "FFmpeg has no HuffYUV encoder";
  VideoFile video(folder / "wave.avi");
  EXPECT_TRUE(video.is_lossless());
  EXPECT_EQ(video.announced_frames(), static_cast<std::size_t>(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    const cv::Mat frame = video.next();
    ASSERT_EQ(frame.type(), CV_8UC3) << i;
    EXPECT_EQ(cv::norm(frame, numbered_frame(i), cv::NORM_INF), 0) << i;
  }
  EXPECT_TRUE(video.next().empty());
}

TEST(VideoFile, KnowsThatACodecLoses) {
  const ScratchFolder folder;
  if (!write_numbered_video(folder / "wave.avi", "MJPG"))
    GTEST_SKIP() << "FFmpeg has no JPEG encoder";
  VideoFile video(folder / "wave.avi");
  EXPECT_FALSE(video.is_lossless());
  EXPECT_GT(cv::norm(video.next(), numbered_frame(0), cv::NORM_INF), 0);
}

TEST(VideoFile, RefusesWhatIsNoVideo) {
  const ScratchFolder folder;
  const auto text = written(folder, "text.avi", "no video at all");
  EXPECT_NE(message_of<FileError>([&] { const VideoFile video(text); }).find("text.avi"),
            std::string::npos);
  EXPECT_NE(message_of<FileError>([&] {
              const VideoFile video(folder / "missing.avi");
            }).find("no such file"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
