// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/depth_recording.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

// The first lines are those of rgbd_dataset_freiburg1_xyz, in another order.
const std::string kDepths =
    "# depth maps\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n# timestamp filename\n"
    "1305031102.194330 depth/1305031102.194330.png\n"
    "1305031102.160407 depth/1305031102.160407.png\n"
    "1305031102.262886 depth/1305031102.262886.png\n";

TEST(DepthRecording, ListsDepthsByTimeWithTheColourNearestInTime) {
  const ScratchFolder folder;
  EXPECT_FALSE(is_depth_recording(folder.path()));
  write_text(folder / "depth.txt", kDepths);
  write_text(folder / "rgb.txt",
             "# color images\n1305031102.175304 rgb/1305031102.175304.png\n"
             "1305031102.211214 rgb/1305031102.211214.png\n"
             "1305031102.243211 rgb/1305031102.243211.png\n");
  EXPECT_TRUE(is_depth_recording(folder.path()));
  const std::vector<RecordedDepth> recorded = read_depth_recording(folder.path());
  ASSERT_EQ(recorded.size(), 3U);
  EXPECT_EQ(recorded[0].time, 1305031102.160407);
  EXPECT_EQ(recorded[0].depth, folder / "depth/1305031102.160407.png");
  EXPECT_EQ(recorded[0].color, folder / "rgb/1305031102.175304.png");
  EXPECT_EQ(recorded[1].color, folder / "rgb/1305031102.211214.png");
  EXPECT_EQ(recorded[2].color, folder / "rgb/1305031102.243211.png");
}

TEST(DepthRecording, HasNoColourThatWasTakenTooEarlyOrTooLate) {
  const ScratchFolder folder;
  write_text(folder / "depth.txt", "10 depth/a.png\n10.1 depth/b.png\n");
  EXPECT_TRUE(read_depth_recording(folder.path())[0].color.empty());
  write_text(folder / "rgb.txt", "9.979 rgb/early.png\n10.119 rgb/late.png\n");
  const std::vector<RecordedDepth> recorded = read_depth_recording(folder.path());
  EXPECT_TRUE(recorded[0].color.empty());
  EXPECT_EQ(recorded[1].color, folder / "rgb/late.png");
}

TEST(DepthRecording, TakesTheRestOfALineAsTheNameOfTheFile) {
  const ScratchFolder folder;
  write_text(folder / "depth.txt", "  0 depth/my 000000.png \r\n+1\tdepth/my  1.png\n");
  const std::vector<RecordedDepth> recorded = read_depth_recording(folder.path());
  EXPECT_EQ(recorded[0].depth, folder / "depth/my 000000.png");
  EXPECT_EQ(recorded[1].depth, folder / "depth/my  1.png");
  EXPECT_EQ(recorded[1].time, 1);
}

TEST(DepthRecording, FindsOnlyImagesThatAreListed) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "depth");
  for (const char* name : {"a.png", "depth/a.png", "depth/b.png"}) write_text(folder / name, "");
  const auto is_found = [&](const char* name) {
    return DepthRecordings().find(folder / name).has_value();
  };
  EXPECT_FALSE(is_found("depth/a.png"));
  write_text(folder / "depth.txt", "1 depth/a.png\n");
  EXPECT_EQ(DepthRecordings().find(folder / "depth/a.png").value().recording, folder.path());
  EXPECT_FALSE(is_found("depth/b.png"));
  EXPECT_FALSE(is_found("a.png"));
  write_text(folder / "depth.txt", "1 a.png\n");  // beside the list
  EXPECT_TRUE(is_found("a.png"));
  EXPECT_FALSE(is_found("depth/a.png"));
  write_text(folder / "depth.txt", "1 depth/a.png\nNotes: the depth is that of the water.\n");
  EXPECT_FALSE(is_found("depth/a.png"));
}

TEST(DepthRecordings, AreReadOnce) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "depth/depth");
  write_text(folder / "depth/a.png", "");
  write_text(folder / "depth.txt", "1 depth/a.png\n");
  write_text(folder / "depth/depth.txt", "The depth of the water.\n");
  DepthRecordings recordings;
  EXPECT_EQ(recordings.read(folder.path()).size(), 1U);
  for (const char* list : {"depth.txt", "depth/depth.txt"}) write_text(folder / list, "soon\n");
  EXPECT_EQ(recordings.read(folder / "depth/..").size(), 1U);
  EXPECT_TRUE(recordings.find(folder / "depth/a.png"));
  write_text(folder / "depth/depth.txt", "2 a.png\n");
  EXPECT_EQ(recordings.find(folder / "depth/a.png").value().time, 1);
  const auto refusal = [&] { (void)recordings.read(folder / "depth"); };
  const std::string first = message_of<FileError>(refusal);
  EXPECT_NE(first.find("depth.txt: line 1: a time"), std::string::npos) << first;
  EXPECT_EQ(message_of<FileError>(refusal), first);
}

TEST(DepthRecording, NamesTheLineThatIsWrong) {
  const ScratchFolder folder;
  const auto refused = [&](const std::string& depths) {
    write_text(folder / "depth.txt", depths);
    return message_of<FileError>([&] { (void)read_depth_recording(folder.path()); });
  };
  EXPECT_NE(refused("1 a.png\n\nsoon b.png\n").find("depth.txt: line 3: a time"),
            std::string::npos);
  EXPECT_NE(refused("1\n").find("line 1: a time"), std::string::npos);
  EXPECT_NE(refused("nan a.png\n").find("line 1: a time"), std::string::npos);
  EXPECT_NE(refused("1 a.png\n1.0 b.png\n").find("line 2: the time 1.0 is there twice"),
            std::string::npos);
  EXPECT_NE(refused("# nothing\n").find("lists no image"), std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
