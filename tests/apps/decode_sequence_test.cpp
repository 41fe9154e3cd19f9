// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Sequences through `palpate decode`: numbers, broken frames, earlier runs, interruption, videos.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "palpate/sensing/frame.h"
#include "run_palpate.h"
#include "shared/result_folder.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

void expect_only_told_of_the_interrupt(const std::string& err) {
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_TRUE(line.starts_with("palpate: interrupted; ") ||
                line.starts_with("palpate: stopping; "))
        << err;
  }
}

class DecodeSequence : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(scratch / "colors.yaml", trained_colors());
    fs::create_directory(scratch / "frames");
    // One colour to another: the flag is small in the image, and so quick to decode.
    for (const char* name : {"0.png", "1.png", "2.png"}) add_frame(name);
  }

  void add_frame(const std::string& name) const {
    fs::copy(demo("frames/flag_a.png"), scratch / ("frames/" + name));
  }

  CommandResult decode(const std::string& frames, std::vector<std::string> more = {}) const {
    std::vector<std::string> call = {"decode",    frames,
                                     "--rig",     demo("rig.yaml"),
                                     "--pattern", demo("pattern.yaml"),
                                     "--colors",  scratch / "colors.yaml",
                                     "-o",        scratch / "range"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }

  nlohmann::json figures(const std::string& frames, std::vector<std::string> more = {}) const {
    more.emplace_back("--json");
    const CommandResult result = decode(frames, more);
    EXPECT_EQ(result.status, kDone) << result.err;
    return nlohmann::json::parse(result.out);
  }

  CommandResult interrupt(const std::vector<std::string>& more, const std::string& at) const {
    std::vector<std::string> call = {
        "decode",    scratch / "frames",   "--rig",    demo("rig.yaml"),
        "--pattern", demo("pattern.yaml"), "--colors", scratch / "colors.yaml",
        "-o",        scratch / "range",    "--quiet"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call, {.interrupt_when_there_is = at});
  }

  /// The output folder as a reader sees it: all files except hidden ones, with their content.
  std::map<std::string, std::string> results() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(scratch / "range")) {
      const std::string name = entry.path().filename().string();
      if (!name.starts_with('.')) files[name] = read_text(entry.path());
    }
    return files;
  }

  int hidden() const {
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(scratch / "range"))
      count += entry.path().filename().string().starts_with('.') ? 1 : 0;
    return count;
  }

  std::string map(int number) const {
    return scratch / std::string("range/00000").append(std::to_string(number)).append(".tiff");
  }

  ScratchFolder scratch;
};

TEST_F(DecodeSequence, ResumingKeepsWhatIsFinishedAndDoesTheRest) {
  EXPECT_EQ(figures(scratch / "frames")["kept"], 0);
  const std::string first = read_text(map(0));
  const auto written = fs::last_write_time(map(0));
  fs::remove(map(1));
  add_frame("3.png");
  const nlohmann::json again = figures(scratch / "frames", {"--resume"});
  EXPECT_EQ(again["decoded"], 4);
  EXPECT_EQ(again["kept"], 2);
  EXPECT_EQ(again["per_frame"][0]["kept"], true);
  EXPECT_EQ(again["per_frame"][1]["kept"], false);
  EXPECT_GT(again["per_frame"][0]["median_depth"], 1000);
  EXPECT_EQ(fs::last_write_time(map(0)), written);
  for (const int number : {0, 1, 2, 3}) EXPECT_EQ(read_text(map(number)), first) << number;
}

TEST_F(DecodeSequence, ResumingDecodesAFrameAnewThatIsAnotherNow) {
  figures(scratch / "frames");
  fs::copy(demo("frames/flag_b.png"), scratch / "frames/1.png",
           fs::copy_options::overwrite_existing);
  EXPECT_EQ(figures(scratch / "frames", {"--resume"})["kept"], 2);
  EXPECT_NE(read_text(map(0)), read_text(map(1)));
  // Outputs that only this call requests are made for all frames.
  EXPECT_EQ(figures(scratch / "frames", {"--resume", "--reasons"})["kept"], 0);
  EXPECT_TRUE(fs::exists(scratch / "range/000002_reasons.tiff"));
}

TEST_F(DecodeSequence, ResumingSurvivesARecordThatACrashCutOff) {
  figures(scratch / "frames");
  const std::string record = read_text(scratch / "range/decode.jsonl");
  EXPECT_EQ(std::count(record.begin(), record.end(), '\n'), 1 + 3);
  write_text(scratch / "range/decode.jsonl", record.substr(0, record.size() - 10));
  EXPECT_EQ(figures(scratch / "frames", {"--resume"})["kept"], 2);
  EXPECT_EQ(figures(scratch / "frames", {"--resume"})["kept"], 3);
}

TEST_F(DecodeSequence, ResumingDecodesFramesAnewWhosePicturesAreMissing) {
  const std::string frame = scratch / "frames/0.png";
  const std::vector<std::string> all = {"--pictures", "--sigma", "--reasons", "--resume"};
  figures(frame, all);
  for (const char* ending : {".png", "_sigma.png", "_reasons.png"}) {
    const std::string picture = scratch / (std::string("range/000000") + ending);
    const std::string drawn = read_text(picture);
    fs::remove(picture);
    EXPECT_EQ(figures(frame, all)["kept"], 0) << ending;
    EXPECT_EQ(read_text(picture), drawn) << ending;
  }
  EXPECT_EQ(figures(frame, all)["kept"], 1);
}

TEST_F(DecodeSequence, DeviationsAndReasonsAreDrawnOnlyAsPictures) {
  const nlohmann::json written = figures(scratch / "frames", {"--sigma", "--reasons"});
  for (const auto& entry : fs::directory_iterator(scratch / "range"))
    EXPECT_NE(entry.path().extension(), ".png") << entry.path();
  EXPECT_TRUE(fs::exists(scratch / "range/000002_sigma.tiff"));
  EXPECT_TRUE(fs::exists(scratch / "range/000002_reasons.tiff"));
  EXPECT_EQ(figures(scratch / "frames", {"--sigma", "--reasons", "--resume"})["kept"], 3);
}

TEST_F(DecodeSequence, TheTimeOfWritingContainsThePictures) {
  const nlohmann::json drawn = figures(scratch / "frames/0.png", {"--pictures"});
  // [s] of a run that mostly draws.
  const double run = 1 / drawn["frames_per_second"].get<double>();
  const double writing = drawn["write_ms_per_frame"].get<double>() / 1000;
  EXPECT_LE(writing, run);
  EXPECT_GE(writing, run / 2);
}

// The run reads none of its outputs again: they may be removed meanwhile.
TEST_F(DecodeSequence, PicturesNeedNoFileThatTheRunHasWritten) {
  std::atomic<bool> done = false;
  std::thread remover([&] {
    while (!done) {
      for (const char* file : {"rig.yaml", "000000.tiff", "000001.tiff", "000002.tiff"}) {
        std::error_code ignored;
        fs::remove(fs::path(scratch / "range") / file, ignored);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const CommandResult result = decode(scratch / "frames", {"--pictures"});
  done = true;
  remover.join();
  EXPECT_EQ(result.status, kDone) << result.err;
  for (const char* picture : {"range/000000.png", "range/000001.png", "range/000002.png"})
    EXPECT_TRUE(fs::exists(scratch / picture)) << picture;
}

TEST_F(DecodeSequence, ResumingWithOtherSettingsOrFramesIsRefused) {
  figures(scratch / "frames");
  const std::string before = read_text(map(1));
  const auto refusal = [&](const std::vector<std::string>& more) {
    std::vector<std::string> call = {"--resume"};
    call.insert(call.end(), more.begin(), more.end());
    const CommandResult result = decode(scratch / "frames", call);
    EXPECT_EQ(result.status, kWrongCall);
    EXPECT_EQ(read_text(map(1)), before);
    return result.err;
  };
  EXPECT_NE(refusal({"--bayer", "rggb"}).find("another --bayer"), std::string::npos);
  EXPECT_NE(refusal({"--half-resolution"}).find("another --half-resolution"), std::string::npos);
  EXPECT_NE(refusal({"--window-periods", "3"}).find("another --window-periods"), std::string::npos);
  fs::rename(scratch / "frames/0.png", scratch / "frames/9.png");
  EXPECT_NE(refusal({}).find("file 0 of the frames was 0.png and is now 1.png"), std::string::npos);
  write_text(scratch / "range/decode.jsonl", "{}\n");
  EXPECT_NE(refusal({}).find("this is not a record of palpate decode"), std::string::npos);
}

TEST_F(DecodeSequence, TheRigBesideHalfRangeMapsIsTheirs) {
  EXPECT_EQ(figures(scratch / "frames/0.png", {"--half-resolution"})["decoded"], 1);
  const std::string rig = scratch / "range/rig.yaml";
  EXPECT_NE(read_text(rig).find("camera_size: [ 320, 240 ]"), std::string::npos) << read_text(rig);
  const CommandResult mesh = run_palpate({"mesh", map(0), "-o", scratch / "flag.ply"});
  EXPECT_EQ(mesh.status, kDone) << mesh.err;
  // A smaller rig would have to replace it.
  const CommandResult again = run_palpate(
      {"decode", scratch / "frames", "--rig", rig, "--pattern", demo("pattern.yaml"), "--colors",
       scratch / "colors.yaml", "-o", scratch / "range", "--half-resolution"});
  EXPECT_EQ(again.status, kWrongCall);
  EXPECT_NE(again.err.find("another folder"), std::string::npos) << again.err;
}

TEST_F(DecodeSequence, ALaterRunLeavesNothingOfAnEarlierOne) {
  figures(scratch / "frames", {"--meshes", "ply", "--reasons"});
  EXPECT_TRUE(fs::exists(scratch / "range/000002.ply"));
  write_text(scratch / "range/notes.txt", "mine");
  figures(demo("frames/flag_b.png"));
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(scratch / "range"))
    left.push_back(entry.path().filename().string());
  std::sort(left.begin(), left.end());
  EXPECT_EQ(left, (std::vector<std::string>{"000000.tiff", "decode.jsonl", "frames.csv",
                                            "notes.txt", "rig.yaml"}));
}

TEST_F(DecodeSequence, RangeMapsThatNoRunMadeAreNotTouched) {
  fs::create_directory(scratch / "range");
  write_text(scratch / "range/000007.tiff", "somebody's");
  const CommandResult result = decode(scratch / "frames");
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_NE(result.err.find("000007.tiff: would be replaced, but the folder has no decode.jsonl"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(read_text(scratch / "range/000007.tiff"), "somebody's");
  EXPECT_FALSE(fs::exists(map(0)));
}

TEST_F(DecodeSequence, BrokenFramesLeaveTheNumbersOfTheOthers) {
  write_text(scratch / "frames/1.png", "this is no image");
  sensing::write_png(scratch / "frames/2.png", cv::Mat(48, 64, CV_8UC3, cv::Scalar()));
  add_frame("3.png");
  const CommandResult result = decode(scratch / "frames", {"--json"});
  EXPECT_EQ(result.status, kWorkFailed);
  EXPECT_NE(result.err.find("1.png: neither PNG, TIFF, BMP, JPEG nor WebP"), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("2.png: frame: is 64 x 48 px"), std::string::npos) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["broken"], 2);
  EXPECT_EQ(report["per_frame"][3]["range_map"], map(3));
  EXPECT_TRUE(fs::exists(map(0)) && fs::exists(map(3)));
  EXPECT_FALSE(fs::exists(map(1)) || fs::exists(map(2)));
  EXPECT_EQ(read_text(scratch / "range/frames.csv"),
            "range_map,frame\n000000.tiff,0.png\n000003.tiff,3.png\n");
  // The broken frame has been replaced: only it is decoded.
  fs::remove(scratch / "frames/1.png");
  fs::remove(scratch / "frames/2.png");
  add_frame("1.png");
  add_frame("2.png");
  EXPECT_EQ(figures(scratch / "frames", {"--resume"})["kept"], 2);
}

TEST_F(DecodeSequence, InterruptingKeepsWhatIsFinished) {
  for (int i = 10; i < 22; ++i) add_frame(std::to_string(i) + ".png");
  const CommandResult stopped = interrupt({}, map(2));
  EXPECT_EQ(stopped.status, 130);
  EXPECT_NE(stopped.err.find("interrupted"), std::string::npos);
  const nlohmann::json rest = figures(scratch / "frames", {"--resume"});
  EXPECT_EQ(rest["decoded"], 15);
  EXPECT_GE(rest["kept"], 1);
  EXPECT_LT(rest["kept"], 15);
  EXPECT_EQ(hidden(), 0);
}

TEST_F(DecodeSequence, AnEarlierRunStaysAsAWholeUntilAnotherOneIsComplete) {
  figures(scratch / "frames", {"--reasons"});
  const auto before = results();
  for (int i = 10; i < 22; ++i) add_frame(std::to_string(i) + ".png");
  const std::vector<std::string> other = {"--window-periods", "3"};
  const CommandResult stopped = interrupt(other, scratch / "range/.palpate-unfinished/000002.tiff");
  EXPECT_EQ(stopped.status, 130);
  expect_only_told_of_the_interrupt(stopped.err);
  EXPECT_NE(stopped.err.find("range holds the results of the earlier run, unchanged; "),
            std::string::npos)
      << stopped.err;
  EXPECT_NE(stopped.err.find(" of 15 frames are finished and kept apart; continue with --resume"),
            std::string::npos)
      << stopped.err;
  EXPECT_EQ(results(), before);
  const nlohmann::json rest = figures(scratch / "frames", {"--resume", "--window-periods", "3"});
  EXPECT_EQ(rest["decoded"], 15);
  EXPECT_GE(rest["kept"], 1);
  EXPECT_LT(rest["kept"], 15);
  const auto after = results();
  EXPECT_EQ(after.size(), 15u + 3);  // with record, table and rig, without reasons
  EXPECT_NE(after.at("000000.tiff"), before.at("000000.tiff"));
  EXPECT_EQ(hidden(), 0);
}

TEST_F(DecodeSequence, AFullDiskLeavesTheEarlierRunAsItWas) {
  figures(scratch / "frames");
  const auto before = results();
  const CommandResult full = run_palpate(
      {"decode", scratch / "frames", "--rig", demo("rig.yaml"), "--pattern", demo("pattern.yaml"),
       "--colors", scratch / "colors.yaml", "-o", scratch / "range", "--window-periods", "3"},
      {.max_file_size = 10000});
  EXPECT_EQ(full.status, kWorkFailed);
  EXPECT_NE(full.err.find(".tiff: cannot be written: File too large. What was there before is "
                          "unchanged"),
            std::string::npos)
      << full.err;
  EXPECT_EQ(results(), before);
  figures(scratch / "frames", {"--window-periods", "3"});
  EXPECT_EQ(hidden(), 0);
}

TEST_F(DecodeSequence, ASecondRunIntoTheFolderIsRefused) {
  figures(scratch / "frames");
  const auto before = results();
  {
    const ResultFolder of_another_run(
        scratch / "range", [](const fs::path&) { return std::vector<fs::path>(); },
        ResultFolder::Unfinished::kept);
    const CommandResult second = decode(demo("frames/flag_b.png"));
    EXPECT_EQ(second.status, kWorkFailed);
    EXPECT_NE(second.err.find("range: another run of palpate is writing into this folder"),
              std::string::npos)
        << second.err;
    EXPECT_EQ(results(), before);
  }
  EXPECT_EQ(decode(demo("frames/flag_b.png")).status, kDone);
}

// The new results of two frames are complete, but still lie beside those of three.
TEST_F(DecodeSequence, ResultsThatAKilledRunDidNotPutInTheirPlaceAreNotReadButPutThere) {
  figures(scratch / "frames", {"--window-periods", "3"});
  const auto before = results();
  fs::remove(scratch / "frames/2.png");
  fs::rename(scratch / "range", scratch / "earlier");
  figures(scratch / "frames");
  const auto after = results();
  for (const char* state : {".palpate-finished", ".palpate-placing"}) {
    fs::remove_all(scratch / "range");
    fs::create_directory(scratch / "range");
    fs::create_directory(scratch.path() / "range" / state);
    for (const auto& [name, content] : before) write_text(scratch.path() / "range" / name, content);
    for (const auto& [name, content] : after)
      write_text(scratch.path() / "range" / state / name, content);
    if (std::string(state) == ".palpate-placing") {
      fs::remove(map(2));
      fs::rename(scratch.path() / "range" / state / "000000.tiff", map(0));
    }
    const CommandResult mesh = run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes"});
    EXPECT_EQ(mesh.status, kWrongCall);
    EXPECT_NE(mesh.err.find("files of two runs"), std::string::npos) << mesh.err;
    EXPECT_EQ(figures(scratch / "frames", {"--resume"})["kept"], 2);
    EXPECT_EQ(results(), after);
    EXPECT_EQ(hidden(), 0);
  }
}

// Ctrl-C in a terminal also interrupts the X server in memory.
TEST_F(DecodeSequence, InterruptingWhileItDrawsIsNoErrorOfTheXServer) {
  for (int i = 10; i < 22; ++i) add_frame(std::to_string(i) + ".png");
  const CommandResult stopped = interrupt({"--pictures", "--sigma"}, scratch / "range/000001.png");
  EXPECT_EQ(stopped.status, 130);
  expect_only_told_of_the_interrupt(stopped.err);
  EXPECT_NE(stopped.err.find(" of 15 frames are finished and kept; continue with --resume"),
            std::string::npos)
      << stopped.err;
  EXPECT_EQ(hidden(), 0);
}

TEST_F(DecodeSequence, AVideoWithoutLossesGivesWhatItsImagesGive) {
  const auto quoted = [](const fs::path& path) { return " '" + path.string() + "'"; };
  const std::string write = quoted(PALPATE_WRITE_VIDEO) + quoted(scratch / "wave.mkv") +
                            quoted(demo("frames/flag_a.png")) + quoted(demo("frames/flag_b.png"));
  ASSERT_EQ(std::system(write.c_str()), 0);
  const nlohmann::json from_video = figures(scratch / "wave.mkv");
  EXPECT_EQ(from_video["per_frame"][1]["frame"], "wave.mkv#1");
  const std::string first = read_text(map(0)), second = read_text(map(1));
  figures(demo("frames/flag_a.png"));
  EXPECT_EQ(read_text(map(0)), first);
  figures(demo("frames/flag_b.png"));
  EXPECT_EQ(read_text(map(0)), second);
}

TEST_F(DecodeSequence, ARawMosaicGivesNearlyTheDepthsOfTheWholeImage) {
  const cv::Mat image = sensing::read_frame(demo("frames/flag_a.png"));
  cv::Mat mosaic(image.size(), CV_8U);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const int channel = v % 2 != u % 2 ? 1 : v % 2 == 0 ? 2 : 0;  // RGGB
      mosaic.at<unsigned char>(v, u) = image.at<cv::Vec3b>(v, u)[channel];
    }
  }
  sensing::write_png(scratch / "raw.png", mosaic);
  const auto error = [&](const std::string& pattern) {
    EXPECT_EQ(decode(scratch / "raw.png", {"--bayer", pattern}).status, kDone);
    const CommandResult result =
        run_palpate({"compare", map(0), demo("truth/flag_a.tiff"), "--json"});
    EXPECT_EQ(result.status, kDone) << result.err;
    return nlohmann::json::parse(result.out)["median"].get<double>();
  };
  EXPECT_LT(error("rggb"), 0.001 * 1290);  // a thousandth of the distance
  // Without the pattern, one channel is not enough.
  EXPECT_EQ(decode(scratch / "raw.png").status, kWrongCall);
}

TEST_F(DecodeSequence, ReasonsAreAnImageWithALegendAndCodesThatInfoCounts) {
  figures(scratch / "frames/0.png", {"--reasons", "--pictures"});
  const cv::Mat codes = sensing::read_frame(scratch / "range/000000_reasons.tiff");
  ASSERT_EQ(codes.type(), CV_8UC1);
  const CommandResult result =
      run_palpate({"info", scratch / "range/000000_reasons.tiff", "--json"});
  const auto info = nlohmann::json::parse(result.out);
  EXPECT_EQ(info["kind"], "reasons");
  EXPECT_EQ(info["pixels"]["reconstructed"], codes.total() - cv::countNonZero(codes));
  EXPECT_EQ(sensing::read_frame(scratch / "range/000000_reasons.png").size(), cv::Size(1200, 900));
  // Codes are no range maps.
  EXPECT_EQ(
      nlohmann::json::parse(run_palpate({"info", scratch / "range", "--json"}).out)["range_maps"],
      1);
}

}  // namespace
}  // namespace palpate::apps
