// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/recording.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kFrameBytes = 100;

/// A camera that sends the frames of a test, as fast as it is asked; then nothing.
class ScriptedCamera : public LiveCamera {
 public:
  explicit ScriptedCamera(std::deque<std::uint64_t> numbers) : numbers_(std::move(numbers)) {
    state_.name = "scripted";
  }
  [[nodiscard]] const CameraState& state() const override { return state_; }
  void set_exposure(double) override {}
  void start() override { started = true; }
  [[nodiscard]] std::optional<CameraFrame> next(milliseconds) override {
    if (before_frame) before_frame(sent);
    if (numbers_.empty() && fails) throw DeviceError("scripted: unplugged");
    if (numbers_.empty()) return std::nullopt;
    const std::uint64_t number = numbers_.front();
    numbers_.pop_front();
    ++sent;
    return CameraFrame{
        .image = cv::Mat(10, 10, CV_8U, cv::Scalar(static_cast<double>(number % 256))),
        .number = number,
        .time = 0.01 * static_cast<double>(number)};
  }
  bool started = false;
  bool fails = false;
  std::size_t sent = 0;
  std::function<void(std::size_t sent)> before_frame;

 private:
  CameraState state_;
  std::deque<std::uint64_t> numbers_;
};

std::deque<std::uint64_t> first(std::uint64_t count) {
  std::deque<std::uint64_t> numbers;
  for (std::uint64_t i = 0; i < count; ++i) numbers.push_back(i);
  return numbers;
}

/// The frames that were written, by index.
struct Written {
  std::mutex mutex;
  std::map<std::size_t, RecordedFrame> frames;
  void operator()(const RecordedFrame& frame) {
    const std::lock_guard lock(mutex);
    frames[frame.index] = frame;
  }
};

/// A gate that holds threads until it is opened.
class Gate {
 public:
  void wait() {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [&] { return open_; });
  }
  void open() {
    {
      const std::lock_guard lock(mutex_);
      open_ = true;
    }
    news_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  bool open_ = false;
};

TEST(Recording, WritesEveryFrameWithItsNumberAndTime) {
  ScriptedCamera camera(first(50));
  Written written;
  const Recording recording = record(camera, {.frames = 20}, {.write = std::ref(written)});
  EXPECT_TRUE(camera.started);
  EXPECT_EQ(recording.frames, 20U);
  EXPECT_EQ(recording.broken_off, "");
  EXPECT_TRUE(recording.lost.empty());
  EXPECT_DOUBLE_EQ(recording.seconds, 0.19);
  ASSERT_EQ(written.frames.size(), 20U);
  for (const auto& [index, frame] : written.frames) {
    EXPECT_EQ(frame.number, index);
    EXPECT_DOUBLE_EQ(frame.time, 0.01 * static_cast<double>(index));
    EXPECT_EQ(cv::countNonZero(frame.image != static_cast<int>(index)), 0);
  }
}

TEST(Recording, EndsAfterTheTimeOfTheCamera) {
  ScriptedCamera camera(first(500));
  Written written;
  EXPECT_EQ(record(camera, {.seconds = 0.1}, {.write = std::ref(written)}).frames, 10U);
}

TEST(Recording, FramesThatNeverArrivedAreListedByNumber) {
  ScriptedCamera camera({2, 3, 4, 9, 10, 12});
  Written written;
  const Recording recording = record(camera, {.frames = 6}, {.write = std::ref(written)});
  ASSERT_EQ(recording.lost.size(), 3U);
  EXPECT_EQ(recording.lost[0].first, 0U);
  EXPECT_EQ(recording.lost[0].count, 2U);
  EXPECT_EQ(recording.lost[1].first, 5U);
  EXPECT_EQ(recording.lost[1].count, 4U);
  EXPECT_EQ(recording.lost[2].first, 11U);
  EXPECT_FALSE(recording.lost[2].by_memory);
  EXPECT_EQ(count_lost(recording.lost), 7U);
  // Their places in the recording have no gaps.
  EXPECT_EQ(written.frames.rbegin()->first, 5U);
  EXPECT_EQ(written.frames.rbegin()->second.number, 12U);
}

TEST(Recording, ASlowDiskNeverHoldsTheCameraUpAndWhatIsLostIsListed) {
  ScriptedCamera camera(first(100));
  Gate disk;
  camera.before_frame = [&](std::size_t sent) {
    if (sent == 100) disk.open();
  };
  Written written;
  const auto write = [&](const RecordedFrame& frame) {
    disk.wait();
    written(frame);
  };
  const Recording recording =
      record(camera, {.memory = 10 * kFrameBytes, .patience = 0.01}, {.write = write});
  EXPECT_EQ(camera.sent, 100U);
  EXPECT_EQ(recording.frames, 10U);  // as much as there was memory for
  EXPECT_EQ(recording.most_waiting, 10U);
  EXPECT_EQ(written.frames.size(), 10U);
  ASSERT_EQ(recording.lost.size(), 1U);
  EXPECT_EQ(recording.lost[0].first, 10U);
  EXPECT_EQ(recording.lost[0].count, 90U);
  EXPECT_TRUE(recording.lost[0].by_memory);
}

TEST(Recording, ASlowDecoderBeginsAtMostTwoFramesBehindAndTheRestIsRecorded) {
  ScriptedCamera camera(first(100));
  Gate busy;
  std::atomic<std::size_t> begun = 0;
  camera.before_frame = [&](std::size_t sent) {
    while (sent == 1 && begun == 0) std::this_thread::yield();  // the decoder has the first one
    if (sent == 100) busy.open();
  };
  std::vector<std::uint64_t> decoded;
  Written written;
  const Recording recording =
      record(camera, {.patience = 0.01, .decoders = 1},
             {.write = std::ref(written), .decode = [&](const RecordedFrame& frame) {
                decoded.push_back(frame.number);
                ++begun;
                busy.wait();
              }});
  EXPECT_EQ(decoded, (std::vector<std::uint64_t>{0, 98, 99}));
  EXPECT_EQ(recording.skipped, 97U);
  EXPECT_EQ(recording.frames, 100U);
  EXPECT_EQ(written.frames.size(), 100U);
}

TEST(Recording, ACameraThatStopsSendingEndsItWithWordsAndWithAllFrames) {
  ScriptedCamera camera(first(7));
  Written written;
  const Recording recording =
      record(camera, {.frames = 10, .patience = 0.01}, {.write = std::ref(written)});
  EXPECT_NE(recording.broken_off.find("scripted: sent no frame for 0.01 s; check its cable"),
            std::string::npos)
      << recording.broken_off;
  EXPECT_EQ(recording.frames, 7U);
  EXPECT_EQ(written.frames.size(), 7U);
}

TEST(Recording, ACameraThatIsUnpluggedEndsItWithAllFrames) {
  ScriptedCamera camera(first(7));
  camera.fails = true;
  Written written;
  const Recording recording = record(camera, {.frames = 10}, {.write = std::ref(written)});
  EXPECT_EQ(recording.broken_off, "scripted: unplugged");
  EXPECT_EQ(written.frames.size(), 7U);
}

TEST(Recording, EndsWhenItIsToldTo) {
  ScriptedCamera camera(first(50));
  Written written;
  std::size_t told = 0;
  const Recording recording = record(
      camera, {}, {.write = std::ref(written), .go_on = [&](std::size_t recorded, std::uint64_t) {
                     told = recorded;
                     return recorded < 5;
                   }});
  EXPECT_EQ(recording.frames, 5U);
  EXPECT_EQ(told, 5U);
  EXPECT_EQ(written.frames.size(), 5U);
}

TEST(Recording, AFullDiskEndsItWithTheMessageOfTheWriter) {
  ScriptedCamera camera(first(1000));
  camera.before_frame = [](std::size_t) { std::this_thread::yield(); };
  const auto write = [](const RecordedFrame& frame) {
    if (frame.index == 3) throw OutputError("the disk is full");
  };
  EXPECT_EQ(message_of<OutputError>([&] { (void)record(camera, {}, {.write = write}); }),
            "the disk is full");
}

TEST(Recording, OptionsOutOfRangeAreRefusedByName) {
  ScriptedCamera camera({});
  const auto message = [&](const RecordingOptions& options) {
    return message_of<InvalidInput>(
        [&] { (void)record(camera, options, {.write = [](const RecordedFrame&) {}}); });
  };
  EXPECT_NE(message({.frames = 0}).find("RecordingOptions::frames is 0"), std::string::npos);
  EXPECT_NE(message({.seconds = -1}).find("RecordingOptions::seconds is -1"), std::string::npos);
  EXPECT_NE(message({.patience = 0}).find("RecordingOptions::patience"), std::string::npos);
  EXPECT_FALSE(camera.started);
}

/// A camera whose frames show the scene at the start of their exposure, and wait in a buffer.
class LateCamera : public LiveCamera {
 public:
  [[nodiscard]] const CameraState& state() const override { return state_; }
  void set_exposure(double) override {}
  void start() override {}
  [[nodiscard]] std::optional<CameraFrame> next(milliseconds wait) override {
    if (buffer_.empty() && wait.count() > 0) expose();
    if (buffer_.empty()) return std::nullopt;
    CameraFrame frame = buffer_.front();
    buffer_.pop_front();
    return frame;
  }
  /// A frame is finished; the exposure of the next one begins.
  void expose() {
    buffer_.push_back({.image = cv::Mat(1, 1, CV_8U, cv::Scalar(exposing_)), .number = count_++});
    exposing_ = scene;
  }
  int scene = 0;

 private:
  CameraState state_;
  std::deque<CameraFrame> buffer_;
  int exposing_ = 0;
  std::uint64_t count_ = 0;
};

TEST(TakeFresh, PassesOverFramesThatWereExposedBefore) {
  LateCamera camera;
  for (int i = 0; i < 3; ++i) camera.expose();
  camera.scene = 7;
  EXPECT_EQ(take_fresh(camera, 1).image.at<unsigned char>(0), 7);
}

TEST(TakeFresh, ACameraThatSendsNothingIsNamed) {
  ScriptedCamera camera({});
  const std::string message = message_of<DeviceError>([&] { (void)take_fresh(camera, 0.01); });
  EXPECT_NE(message.find("scripted: sent no frame for 0.01 s"), std::string::npos) << message;
}

}  // namespace
}  // namespace palpate::sensing
