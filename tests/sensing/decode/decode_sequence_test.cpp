// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decode_sequence.h"

#include <gtest/gtest.h>

#include <atomic>
#include <opencv2/core.hpp>
#include <vector>

#include "palpate/error.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

/// A small camera, so that a long sequence takes little time.
struct Setting {
  Rig rig = small_rig();
  Pattern pattern = make_pattern(Axis::y, 10, 1024);
  Decoder decoder{rig, pattern, ideal_colors()};

  static Rig small_rig() {
    Rig rig = make_rig(false);
    rig.camera = {.width = 80, .height = 60, .fx = 550, .fy = 550, .cx = 39.5, .cy = 29.5};
    return rig;
  }
  [[nodiscard]] cv::Mat frame(double distance) const {
    return render(rig, pattern, plane(Eigen::Vector3d::UnitZ(), distance)).frame;
  }
};

/// `count` frames, each read by `read`.
std::function<std::optional<SourceFrame>()> counted(std::size_t count,
                                                    std::function<cv::Mat(std::size_t)> read) {
  return [=, i = std::size_t{0}]() mutable -> std::optional<SourceFrame> {
    if (i == count) return std::nullopt;
    const std::size_t number = i++;
    return SourceFrame{
        .number = number, .name = "frame " + std::to_string(number), .file = {}, .read = [=] {
          return read(number);
        }};
  };
}

TEST(DecodeSequence, GivesWhatTheDecoderGivesInTheOrderOfTheFrames) {
  const Setting setting;
  const std::vector<cv::Mat> frames = {setting.frame(600), setting.frame(700), setting.frame(800)};
  std::vector<std::size_t> numbers;
  std::atomic<int> in_parallel = 0;
  decode_sequence(counted(30, [&](std::size_t i) { return frames[i % 3]; }), setting.decoder,
                  [&](const DecodedFrame& frame) {
                    EXPECT_EQ(frame.error, "");
                    const DecodeResult expected =
                        setting.decoder.decode(frames[frame.source.number % 3]);
                    EXPECT_GT(count(expected.reasons, Reason::reconstructed), 0);
                    EXPECT_TRUE((frame.result.reasons == expected.reasons).all());
                    EXPECT_TRUE((frame.result.range.z == expected.range.z ||
                                 (frame.result.range.z.isNaN() && expected.range.z.isNaN()))
                                    .all());
                    numbers.push_back(frame.source.number);
                  },
                  {.in_parallel = [&](const DecodedFrame&) { ++in_parallel; }});
  ASSERT_EQ(numbers.size(), 30u);
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], i);
  EXPECT_EQ(in_parallel, 30);
}

TEST(DecodeSequence, BrokenFramesAreDeliveredWithTheirErrorAndOthersStay) {
  const Setting setting;
  const cv::Mat good = setting.frame(700);
  std::vector<std::string> errors;
  decode_sequence(counted(5,
                          [&](std::size_t i) {
                            if (i == 1) throw FileError("frame 1: is truncated");
                            return i == 3 ? cv::Mat(10, 10, CV_8UC3) : good;
                          }),
                  setting.decoder,
                  [&](const DecodedFrame& frame) { errors.push_back(frame.error); },
                  {.in_parallel = [](const DecodedFrame& frame) { EXPECT_EQ(frame.error, ""); }});
  ASSERT_EQ(errors.size(), 5u);
  EXPECT_EQ(errors[0] + errors[2] + errors[4], "");
  EXPECT_EQ(errors[1], "frame 1: is truncated");
  EXPECT_NE(errors[3].find("frame 3: frame: is 10 x 10 px"), std::string::npos) << errors[3];
}

TEST(DecodeSequence, HoldsNoMoreFramesThanItMay) {
  const Setting setting;
  const cv::Mat dark(60, 80, CV_8UC3, cv::Scalar());
  for (const int limit : {1, 5}) {
    // Frames that were read and not yet delivered. Each is a copy of its own.
    std::atomic<int> live = 0, most = 0;
    decode_sequence(counted(500,
                            [&](std::size_t) {
                              const int now = ++live;
                              int seen = most;
                              while (now > seen && !most.compare_exchange_weak(seen, now)) {
                              }
                              return dark.clone();
                            }),
                    setting.decoder, [&](const DecodedFrame&) { --live; },
                    {.max_live_frames = limit});
    EXPECT_EQ(live, 0);
    EXPECT_GE(most, 1);
    EXPECT_LE(most, limit);
  }
}

TEST(DecodeSequence, StopsWithWhatTheReceiverThrows) {
  const Setting setting;
  struct Interrupted {};
  const cv::Mat dark(60, 80, CV_8UC3, cv::Scalar());
  std::size_t delivered = 0;
  EXPECT_THROW(decode_sequence(counted(1000, [&](std::size_t) { return dark; }), setting.decoder,
                               [&](const DecodedFrame& frame) {
                                 EXPECT_EQ(frame.source.number, delivered++);
                                 if (delivered == 10) throw Interrupted{};
                               }),
               Interrupted);
  EXPECT_EQ(delivered, 10u);
  EXPECT_THROW(decode_sequence(counted(1, [&](std::size_t) { return dark; }), setting.decoder,
                               [](const DecodedFrame&) {}, {.max_live_frames = 0}),
               InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
