// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Recording with cameras that need no hardware: the simulated one, and Aravis' own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>
#include <string>
#include <vector>

#include "palpate/sensing/frame.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// The demo's frames as a camera sends them.
std::string simulated() { return "simulated:" + demo("frames"); }

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

class Capture : public ::testing::Test {
 protected:
  CommandResult sequence(std::vector<std::string> more, const CommandOptions& options = {}) {
    more.insert(more.begin(), {"capture", "sequence"});
    more.insert(more.end(), {"-o", frames, "--json"});
    return run_palpate(more, options);
  }
  std::vector<std::string> decoding() {
    write_text(scratch / "colors.yaml", trained_colors());
    return {"--rig",    demo("rig.yaml"),       "--pattern", demo("pattern.yaml"),
            "--colors", scratch / "colors.yaml"};
  }

  ScratchFolder scratch;
  std::string frames = scratch / "frames";
};

TEST_F(Capture, RecordsFramesAsTheCameraSendsThemWithNumbersAndTimes) {
  const CommandResult done = sequence({simulated(), "--rate", "50", "--count", "3"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json figures = json::parse(done.out);
  EXPECT_EQ(figures["frames"], 3);
  EXPECT_EQ(names_in(frames),
            (std::set<std::string>{"capture.jsonl", "times.csv", "frame_000000.tiff",
                                   "frame_000001.tiff", "frame_000002.tiff"}));
  const std::string table = read_text(scratch / "frames/times.csv");
  EXPECT_THAT(table, HasSubstr("file,number,time_s\nframe_000000.tiff,"));
  const cv::Mat first = sensing::read_frame(scratch / "frames/frame_000000.tiff");
  EXPECT_EQ(first.cols, figures["camera"]["camera_size"][0]);
  bool is_one_of_them = false;
  for (const auto& entry : fs::directory_iterator(demo("frames"))) {
    const cv::Mat image = sensing::read_frame(entry.path());
    is_one_of_them = is_one_of_them ||
                     (image.size() == first.size() && cv::norm(image, first, cv::NORM_INF) == 0);
  }
  EXPECT_TRUE(is_one_of_them);
  const CommandResult described = run_palpate({"info", frames, "--json"});
  ASSERT_EQ(described.status, kDone) << described.err;
  EXPECT_EQ(json::parse(described.out)["kind"], "recording");
  EXPECT_EQ(json::parse(described.out)["frames"], 3);
  EXPECT_EQ(json::parse(described.out)["frames_lost"], figures["frames_lost"]);
}

TEST_F(Capture, WhatItSkippedIsDecodedAfterwards) {
  std::vector<std::string> call = {simulated(), "--rate",         "500", "--count", "8",
                                   "--decode",  scratch / "range"};
  for (const std::string& word : decoding()) call.push_back(word);
  const CommandResult done = sequence(call);
  ASSERT_EQ(done.status, kDone) << done.err;
  const json figures = json::parse(done.out);
  const json& live = figures["decoding"];
  EXPECT_EQ(live["verdict"], "accepted");
  EXPECT_EQ(live["broken"], 0);
  EXPECT_GE(live["decoded"], 1);
  EXPECT_EQ(live["decoded"].get<int>() + live["skipped"].get<int>(), 8);
  std::vector<std::string> decode = {"decode",          frames,     "-o",
                                     scratch / "range", "--resume", "--json"};
  for (const std::string& word : decoding()) decode.push_back(word);
  const CommandResult rest = run_palpate(decode);
  ASSERT_EQ(rest.status, kDone) << rest.err;
  EXPECT_EQ(json::parse(rest.out)["kept"], live["decoded"]);
  EXPECT_EQ(json::parse(rest.out)["decoded"], 8);
  // A map from the recording is the one that decode makes.
  decode[3] = scratch / "anew";
  std::erase(decode, "--resume");
  ASSERT_EQ(run_palpate(decode).status, kDone);
  EXPECT_EQ(read_text(scratch / "range/000000.tiff"), read_text(scratch / "anew/000000.tiff"));
  EXPECT_EQ(read_text(scratch / "range/frames.csv"), read_text(scratch / "anew/frames.csv"));
}

TEST_F(Capture, CtrlCEndsItWithAllFilesWritten) {
  const CommandResult done =
      sequence({simulated(), "--rate", "100"},
               {.interrupt_when_there_is = scratch / "frames/frame_000004.tiff"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const std::size_t count = json::parse(done.out)["frames"].get<std::size_t>();
  EXPECT_GE(count, 5U);
  EXPECT_EQ(names_in(frames).size(), count + 2);
  EXPECT_TRUE(fs::exists(scratch / "frames/times.csv"));
}

TEST_F(Capture, AFullDiskEndsItAndTellsHowManyFramesThereAre) {
  const auto bytes = fs::file_size(demo("frames") + "/" + *names_in(demo("frames")).begin());
  const CommandResult done = sequence({simulated(), "--rate", "100"},
                                      {.max_file_size = static_cast<unsigned long>(bytes / 2)});
  EXPECT_EQ(done.status, kWorkFailed);
  EXPECT_THAT(done.err, HasSubstr("frame_00000"));
  EXPECT_THAT(done.err, HasSubstr("The recording has ended; 0 frames are in " + frames));
  EXPECT_FALSE(fs::exists(scratch / "frames/frame_000000.tiff"));
}

TEST_F(Capture, AFolderThatCannotBeWrittenIsRefusedBeforeTheRecording) {
  if (::geteuid() == 0)
    frames = "/proc/frames";
  else {
    fs::create_directory(scratch / "closed");
    fs::permissions(scratch / "closed", fs::perms::owner_read | fs::perms::owner_exec);
    frames = scratch / "closed/frames";
  }
  const CommandResult done = sequence({simulated(), "--count", "1"});
  EXPECT_NE(done.status, kDone);
  EXPECT_THAT(done.err, HasSubstr("frames: cannot be written"));
}

TEST_F(Capture, ARecordingIsNeverReplaced) {
  ASSERT_EQ(sequence({simulated(), "--rate", "100", "--count", "1"}).status, kDone);
  const std::string before = read_text(scratch / "frames/frame_000000.tiff");
  const CommandResult again = sequence({simulated(), "--rate", "100", "--count", "2"});
  EXPECT_EQ(again.status, kWrongCall);
  EXPECT_THAT(again.err, HasSubstr("a recording is never replaced"));
  EXPECT_EQ(names_in(frames).size(), 3U);
  EXPECT_EQ(read_text(scratch / "frames/frame_000000.tiff"), before);
}

TEST_F(Capture, ACameraThatSendsNothingIsReportedAndWhatThereIsKept) {
  const CommandResult done = sequence({simulated(), "--rate", "0.001", "--patience", "0.05"});
  EXPECT_EQ(done.status, kWorkFailed);
  EXPECT_THAT(done.err, HasSubstr("sent no frame for 0.05 s; check its cable"));
  EXPECT_EQ(json::parse(done.out)["frames"], 0);
}

TEST_F(Capture, ACameraOfAnotherSizeThanTheRigIsRefusedBeforeTheRecording) {
  std::vector<std::string> call = {"aravis:Fake_1", "--size",   "320",
                                   "200",           "--decode", scratch / "range"};
  for (const std::string& word : decoding()) call.push_back(word);
  const CommandResult done = sequence(call);
  EXPECT_EQ(done.status, kWrongCall);
  EXPECT_THAT(done.err, HasSubstr("rig.yaml: the rig's camera has "));
  EXPECT_THAT(done.err, HasSubstr("sends 320 x 200 px"));
  EXPECT_FALSE(fs::exists(frames));
  EXPECT_FALSE(fs::exists(scratch / "range"));
}

TEST_F(Capture, WrongCallsSayWhatWouldBeRight) {
  const auto refused = [&](const std::vector<std::string>& call) {
    const CommandResult done = sequence(call);
    EXPECT_EQ(done.status, kWrongCall);
    EXPECT_EQ(done.out, "");
    EXPECT_FALSE(fs::exists(frames));
    return done.err;
  };
  EXPECT_THAT(refused({"webcam"}), HasSubstr("it must be aravis:NAME, v4l2:NUMBER or simulated:"));
  EXPECT_THAT(refused({"v4l2:997"}), HasSubstr("there is no /dev/video997"));
  EXPECT_THAT(refused({"simulated:/no/where"}), HasSubstr("/no/where"));
  EXPECT_THAT(refused({simulated(), "--rate", "0"}), HasSubstr("--rate: is 0"));
  EXPECT_THAT(refused({simulated(), "--count", "0"}), HasSubstr("--count: is 0"));
  EXPECT_THAT(refused({simulated(), "--decode", scratch / "range"}),
              HasSubstr("--decode: needs --rig, --pattern and --colors"));
  EXPECT_THAT(refused({simulated(), "--rig", "rig.yaml"}), HasSubstr("--decode"));
}

TEST_F(Capture, AravisOwnCameraIsRecordedWithItsMosaic) {
  const CommandResult done = sequence({"aravis:Fake_1", "--size", "64", "48", "--rate", "100",
                                       "--pixel-format", "BayerRG8", "--count", "4"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const json figures = json::parse(done.out);
  EXPECT_EQ(figures["camera"]["bayer"], "rggb");
  EXPECT_EQ(figures["camera"]["counts_frames"], true);
  EXPECT_EQ(sensing::read_frame(scratch / "frames/frame_000003.tiff").type(), CV_8UC1);
}

TEST_F(Capture, ListIsJsonAlsoWithoutACamera) {
  const CommandResult done = run_palpate({"capture", "list", "--json"});
  ASSERT_EQ(done.status, kDone) << done.err;
  EXPECT_TRUE(json::parse(done.out)["cameras"].is_array());
}

TEST_F(Capture, StillsWithoutImagesToShowNameTheCommandThatMakesThem) {
  fs::create_directory(scratch / "show");
  sensing::write_png(scratch / "show/other.png", cv::Mat::zeros(8, 8, CV_8U));
  for (const auto& [kind, remedy] : std::vector<std::pair<std::string, std::string>>{
           {"training", "palpate pattern -o"}, {"multishot", "palpate pattern --multishot"}}) {
    const CommandResult done = run_palpate(
        {"capture", kind, simulated(), "--show", scratch / "show", "-o", scratch / "taken"});
    EXPECT_EQ(done.status, kWrongCall);
    EXPECT_THAT(done.err, HasSubstr(remedy));
  }
  const CommandResult poses =
      run_palpate({"capture", "calibration", simulated(), "--show", scratch / "show", "--board",
                   "7x9", "--square", "25", "-o", scratch / "poses"});
  EXPECT_EQ(poses.status, kWrongCall);
  EXPECT_THAT(poses.err, HasSubstr("palpate calibrate rig --draw"));
}

}  // namespace
}  // namespace palpate::apps
