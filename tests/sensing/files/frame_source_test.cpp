// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/frame_source.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

/// An image that shows its number.
cv::Mat numbered_image(int number) {
  cv::Mat image(48, 64, CV_8UC3);
  cv::setRNGSeed(number);
  cv::randu(image, 0, 255);
  return image;
}

std::filesystem::path write_image(const ScratchFolder& folder, const std::string& name,
                                  int number) {
  cv::imwrite((folder / name).string(), numbered_image(number));
  return folder / name;
}

std::filesystem::path write_video(const ScratchFolder& folder, const std::string& name,
                                  const char* codec, int frames) {
  cv::VideoWriter writer((folder / name).string(), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), 25,
                         {64, 48});
  EXPECT_TRUE(writer.isOpened()) << codec;
  for (int i = 0; i < frames; ++i) writer.write(numbered_image(i));
  return folder / name;
}

std::vector<SourceFrame> all_of(FrameSource source) {
  std::vector<SourceFrame> frames;
  while (auto frame = source.next()) frames.push_back(*frame);
  return frames;
}

TEST(FrameSource, GivesImagesFoldersAndVideosInTheirOrder) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "images");
  write_image(folder, "images/b.png", 2);
  write_image(folder, "images/a.tiff", 1);
  write_text(folder / "images/notes.txt", "no image");
  const auto single = write_image(folder, "single.png", 0);
  const auto video = write_video(folder, "wave.avi", "HFYU", 3);
  const FrameSource source({single, folder / "images", video});
  EXPECT_EQ(source.expected_frames(), 6u);
  EXPECT_EQ(source.files().size(), 4u);
  const std::vector<SourceFrame> frames = all_of(FrameSource({single, folder / "images", video}));
  const std::vector<std::string> names = {"single.png", "a.tiff",     "b.png",
                                          "wave.avi#0", "wave.avi#1", "wave.avi#2"};
  const int numbers[] = {0, 1, 2, 0, 1, 2};
  ASSERT_EQ(frames.size(), 6u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].number, i);
    EXPECT_EQ(frames[i].name, names[i]);
    EXPECT_EQ(cv::norm(frames[i].read(), numbered_image(numbers[i]), cv::NORM_INF), 0)
        << frames[i].name;
  }
}

TEST(FrameSource, KnowsWhichVideosLoseNothing) {
  const ScratchFolder folder;
  for (const char* codec : {"FFV1", "HFYU", "MPNG"}) {
    const FrameSource source({write_video(folder, "whole.avi", codec, 2)});
    EXPECT_TRUE(source.warnings().empty()) << codec;
  }
  for (const char* codec : {"MJPG", "mp4v"}) {
    const FrameSource source({write_video(folder, "lossy.mkv", codec, 2)});
    ASSERT_EQ(source.warnings().size(), 1u) << codec;
    EXPECT_NE(source.warnings()[0].find("lossy.mkv: is compressed with losses"), std::string::npos);
  }
}

TEST(FrameSource, WarnsOnceOfImagesWithLosses) {
  const ScratchFolder folder;
  const auto good = write_image(folder, "good.png", 0);
  EXPECT_TRUE(FrameSource({good}).warnings().empty());
  const auto first = write_image(folder, "a.jpg", 1);
  const auto second = write_image(folder, "b.jpeg", 2);
  const FrameSource source({good, first, second});
  ASSERT_EQ(source.warnings().size(), 1U);
  EXPECT_NE(source.warnings()[0].find("a.jpg and 1 more: are compressed with losses"),
            std::string::npos)
      << source.warnings()[0];
  EXPECT_EQ(all_of(FrameSource({folder / "."})).size(), 3U);
}

TEST(FrameSource, ABrokenImageDoesNotStopTheOthers) {
  const ScratchFolder folder;
  const auto good = write_image(folder, "good.png", 0);
  const auto frames = all_of(FrameSource({written(folder, "bad.png", "nothing"), good}));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_THROW((void)frames[0].read(), FileError);
  EXPECT_EQ(frames[1].read().size(), cv::Size(64, 48));
}

TEST(FrameSource, ALinkThatLeadsNowhereIsAFrameThatCannotBeRead) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "images");
  const auto original = write_image(folder, "original.png", 0);
  std::filesystem::create_symlink(folder / "gone.png", folder / "images/0.png");
  std::filesystem::create_symlink(original, folder / "images/1.png");
  const auto frames = all_of(FrameSource({folder / "images"}));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_NE(message_of<FileError>([&] { (void)frames[0].read(); }).find("0.png: no such file"),
            std::string::npos);
  EXPECT_EQ(frames[1].read().size(), cv::Size(64, 48));
}

TEST(FrameSource, AVideoThatBreaksOffSaysWhere) {
  const ScratchFolder folder;
  const auto whole = write_video(folder, "whole.avi", "HFYU", 10);
  const std::string bytes = read_text(whole);
  const auto cut = written(folder, "cut.avi", bytes.substr(0, bytes.size() / 2));
  ::testing::internal::CaptureStderr();  // FFmpeg prints warnings
  const auto frames = all_of(FrameSource({cut, whole}));
  (void)::testing::internal::GetCapturedStderr();
  ASSERT_GT(frames.size(), 12u);
  const std::size_t broken = frames.size() - 11;
  EXPECT_EQ(message_of<FileError>([&] { (void)frames[broken].read(); }),
            cut.string() + ": breaks off after " + std::to_string(broken) +
                " of the 10 frames that it announces");
  EXPECT_EQ(frames[broken + 1].name, "whole.avi#0");
  EXPECT_EQ(frames[broken + 1].number, broken + 1);
}

TEST(FrameSource, DemosaicsImagesAndVideosOfASingleChipCamera) {
  const ScratchFolder folder;
  // Even in each colour, so that no pixel counts as hot.
  cv::Mat mosaic(48, 64, CV_8UC1);
  for (int row = 0; row < mosaic.rows; ++row)
    for (int column = 0; column < mosaic.cols; ++column)
      mosaic.at<unsigned char>(row, column) =
          static_cast<unsigned char>(row + column + 40 * (row % 2) + 20 * (column % 2));
  cv::imwrite((folder / "raw.png").string(), mosaic);
  cv::Mat grey;
  cv::merge(std::vector<cv::Mat>{mosaic, mosaic, mosaic}, grey);
  {
    cv::VideoWriter writer((folder / "raw.avi").string(), cv::CAP_FFMPEG,
                           cv::VideoWriter::fourcc('H', 'F', 'Y', 'U'), 25, {64, 48});
    writer.write(grey);
  }
  const auto frames =
      all_of(FrameSource({folder / "raw.png", folder / "raw.avi"}, {.bayer = BayerPattern::gbrg}));
  const cv::Mat expected = demosaic(mosaic, BayerPattern::gbrg);
  ASSERT_EQ(frames.size(), 2u);
  for (const SourceFrame& frame : frames)
    EXPECT_EQ(cv::norm(frame.read(), expected, cv::NORM_INF), 0) << frame.name;
  const auto colored =
      all_of(FrameSource({write_image(folder, "color.png", 0)}, {.bayer = BayerPattern::rggb}));
  EXPECT_NE(message_of<FileError>([&] { (void)colored[0].read(); }).find("color.png: has 3"),
            std::string::npos);
}

TEST(FrameSource, RefusesWhatIsNotThere) {
  const ScratchFolder folder;
  EXPECT_THROW(FrameSource({folder / "none.png"}), FileError);
  EXPECT_THROW(FrameSource({folder.path()}), FileError);  // empty
  ::testing::internal::CaptureStderr();
  EXPECT_THROW(FrameSource({written(folder, "no.mp4", "this is no video")}), FileError);
  (void)::testing::internal::GetCapturedStderr();
}

}  // namespace
}  // namespace palpate::sensing
