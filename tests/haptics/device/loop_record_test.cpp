// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/loop_record.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "device/slow_file.h"
#include "palpate/core/error.h"
#include "palpate/haptics/rotation.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

const devices::DeviceDescription kDevice{.name = "a \"device\"",
                                         .highest_force = 4,
                                         .continuous_force = 4,
                                         .damping = 1.0 / 3 * 1e-3,
                                         .delay = 1e-3};

DeviceLoopOptions some_options() {
  DeviceLoopOptions options;
  options.T_world_device.linear() = rotation_exp({0.1, 0.2, 0.3});
  options.T_world_device.translation() << 0.1, 0.2, 700;
  options.scale = 1.0 / 3;
  options.safety.ramp = 0.01;
  options.coupling.stiffness = 0.7;
  return options;
}

/// Some ticks that press, with one that is not answered and one that is NaN.
std::vector<TickRecord> some_ticks(const Playback& first, const Playback& second) {
  DeviceLoop loop(kDevice, some_options());
  std::vector<TickRecord> ticks;
  for (int i = 0; i < 300; ++i) {
    TickInput input{.now = 1e-3 * i};
    input.answered = i != 120;
    input.exchanged = i == 200;
    input.state.time = 1e-3 * i;
    input.state.tip = some_options().T_world_device.linear().transpose() *
                      Eigen::Vector3d(0.01 * i, 0, 3 * (-10 + 0.1 * i));
    if (i == 140) input.state.tip.x() = std::numeric_limits<double>::quiet_NaN();
    TickOutput output = loop.tick(i < 200 ? first : second, input);
    const double written = input.now + (i == 250 ? 0.02 : 0);
    loop.check_age(written - input.now, output);
    ticks.push_back(record_of(input, written, output));
  }
  return ticks;
}

class LoopRecordTest : public ::testing::Test {
 protected:
  void write(const std::filesystem::path& path) {
    LoopRecorder recorder(path, kDevice, some_options(), "what it was");
    for (const TickRecord& tick : ticks) {
      recorder.wait_for_room();
      ASSERT_TRUE(recorder.put(tick));
    }
    recorder.finish();
  }

  const ScratchFolder folder;
  const Playback first = Playback(sheet_model()), second = Playback(uneven_model());
  const std::array<const Playback*, 2> models = {&first, &second};
  const std::vector<TickRecord> ticks = some_ticks(first, second);
};

TEST_F(LoopRecordTest, IsReplayedToTheBit) {
  write(folder / "loop.bin");
  const LoopRecord record = read_loop_record(folder / "loop.bin");
  EXPECT_EQ(record.session, "what it was");
  EXPECT_EQ(record.device.name, kDevice.name);
  const LoopReplay again = replay(record, models);
  EXPECT_EQ(again.ticks, 300);
  EXPECT_EQ(again.different, 0);
  const std::vector<TracePoint> trace = trace_of(record);
  ASSERT_EQ(trace.size(), 300U);
  EXPECT_GT(trace[190].force.norm(), 0.1);
  EXPECT_NE(trace[190].state, ContactState::free);
}

TEST_F(LoopRecordTest, TellsWhereAReplayDiffers) {
  LoopRecord record{.device = kDevice, .options = some_options(), .ticks = ticks};
  record.ticks[170].force[2] = std::nextafter(record.ticks[170].force[2], 10.0);
  LoopReplay again = replay(record, models);
  EXPECT_EQ(again.different, 1);
  EXPECT_EQ(again.first_different, 170);
  // Another model shows from the tick in which it comes.
  const std::array<const Playback*, 2> wrong = {&first, &first};
  again = replay(record, wrong);
  EXPECT_GT(again.different, 10);
}

TEST_F(LoopRecordTest, NeedsEveryModelThatWasExchanged) {
  const LoopRecord record{.device = kDevice, .options = some_options(), .ticks = ticks};
  EXPECT_NE(refusal([&] {
              return replay(record, std::span(models).first(1));
            }).find("1 exchanges and needs one more model"),
            std::string::npos);
}

TEST_F(LoopRecordTest, EndsWithItsLastWholeTick) {
  write(folder / "loop.bin");
  const std::string whole = read_text(folder / "loop.bin");
  write_text(folder / "cut.bin", whole.substr(0, whole.size() - 100));
  EXPECT_EQ(read_loop_record(folder / "cut.bin").ticks.size(), 299U);
}

TEST_F(LoopRecordTest, RefusesWhatIsNoRecord) {
  write(folder / "loop.bin");
  const std::string whole = read_text(folder / "loop.bin");
  const auto message = [&](const std::string& text) {
    write_text(folder / "wrong.bin", text);
    return refusal([&] { return read_loop_record(folder / "wrong.bin"); });
  };
  EXPECT_NE(message("t,x,y,z\n").find("is no loop record"), std::string::npos);
  EXPECT_NE(message("{\"format\": 7}\n").find("is no loop record"), std::string::npos);
  EXPECT_NE(message(replaced(whole, "\"version\":2", "\"version\":7")).find("of version 7"),
            std::string::npos);
  EXPECT_NE(message(replaced(whole, "\"slew\":1000.0", "\"slew\":\"x\"")).find("head of the loop"),
            std::string::npos);
}

TEST_F(LoopRecordTest, ReplacesLettersOfANameThatAreNotUnicode) {
  devices::DeviceDescription device = kDevice;
  device.name = "caf\xe9";  // Latin-1
  LoopRecorder(folder / "loop.bin", device, some_options()).finish();
  EXPECT_EQ(read_loop_record(folder / "loop.bin").device.name, "caf\xef\xbf\xbd");
}

TEST_F(LoopRecordTest, SaysThatTheDiskIsFull) {
  LoopRecorder recorder("/dev/full", kDevice, some_options());
  for (const TickRecord& tick : ticks) recorder.put(tick);
  EXPECT_THROW(recorder.finish(), OutputError);
}

// A disk that does not take any more for a while: a pipe that is not read yet.
TEST_F(LoopRecordTest, SaysHowManyTicksWereLostByASlowDisk) {
  SlowFile file(folder / "pipe");
  LoopRecorder recorder(file.path(), kDevice, some_options());
  long long lost = 0;
  for (int i = 0; i < 20'000; ++i) lost += recorder.put(ticks[0]) ? 0 : 1;
  EXPECT_GT(lost, 1000);
  file.take_everything();
  try {
    recorder.finish();
    FAIL() << "the record is not complete";
  } catch (const OutputError& wrong) {
    EXPECT_NE(std::string(wrong.what())
                  .find("the disk was too slow for " + std::to_string(lost) + " ticks"),
              std::string::npos)
        << wrong.what();
  }
}

TEST_F(LoopRecordTest, WaitsForTheDiskWithoutLosingTicks) {
  SlowFile file(folder / "pipe");
  LoopRecorder recorder(file.path(), kDevice, some_options());
  std::atomic<int> taken = 0;
  std::thread loop([&] {
    for (int i = 0; i < 20'000; ++i) {
      recorder.wait_for_room();
      if (recorder.put(ticks[0])) ++taken;
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_LT(taken, 20'000) << "the file does not take that many";
  file.take_everything();
  loop.join();
  recorder.finish();
  EXPECT_EQ(taken, 20'000);
}

TEST_F(LoopRecordTest, ReadsRecordsOfTheFirstVersion) {
  write(folder / "loop.bin");
  std::string old_record = read_text(folder / "loop.bin");
  for (const auto& [words, old] : std::vector<std::pair<std::string, std::string>>{
           {"\"version\":2", "\"version\":1"},
           {"\"continuous_force\":4.0,", ""},
           {"\"continuous_force\":null,\"heating_time\":10.0,", ""}}) {
    ASSERT_NE(old_record.find(words), std::string::npos) << words;
    old_record = replaced(old_record, words, old);
  }
  write_text(folder / "first.bin", old_record);
  const LoopReplay again = replay(read_loop_record(folder / "first.bin"), models);
  EXPECT_EQ(again.ticks, 300);
  EXPECT_EQ(again.different, 0);
}

}  // namespace
}  // namespace palpate::haptics
