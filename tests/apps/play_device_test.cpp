// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate play` with devices, simulated and behind drivers, good and bad ones.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/trajectory_file.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class PlayDevice : public ::testing::Test {
 protected:
  // One model for all: contacts of a sheet at z = 700, 3 N deep by 12 mm.
  static void SetUpTestSuite() {
    scratch = new ScratchFolder;
    for (const std::vector<std::string>& call : std::vector<std::vector<std::string>>{
             {"probe", "import", demo("sheet/contacts.csv"), demo("sheet/samples.csv"), "-o",
              *scratch / "a.db"},
             {"fit", *scratch / "a.db", demo("sheet/surface.ply"), "-o", *scratch / "model"}}) {
      ASSERT_EQ(run_palpate(call).status, kDone);
    }
    fs::copy(*scratch / "model", *scratch / "other", fs::copy_options::recursive);
    const json field = json::parse(read_text(*scratch / "model/field.json"));
    const json place = field["contacts"][field["contacts"].size() / 2]["position"];
    const auto point = [&](double time, double depth) {
      return std::to_string(time) + ',' + std::to_string(place[0].get<double>()) + ',' +
             std::to_string(place[1].get<double>()) + ',' +
             std::to_string(place[2].get<double>() + depth) + '\n';
    };
    write_text(*scratch / "press.csv",
               "t,x,y,z\n" + point(0, -5) + point(0.3, 8) + point(0.6, 8) + point(0.9, -5));
    write_text(*scratch / "pose.txt", "1 0 0 " + std::to_string(place[0].get<double>()) +
                                          "\n0 1 0 " + std::to_string(place[1].get<double>()) +
                                          "\n0 0 1 " + std::to_string(place[2].get<double>()));
  }
  static void TearDownTestSuite() {
    delete scratch;
    scratch = nullptr;
  }

  static json figures(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"play", *scratch / "model"});
    arguments.emplace_back("--json");
    const CommandResult result = run_palpate(arguments);
    EXPECT_EQ(result.status, kDone) << result.err;
    return result.status == kDone ? json::parse(result.out) : json();
  }

  static void expect_words(std::vector<std::string> arguments, int status,
                           const std::string& words) {
    arguments.insert(arguments.begin(), {"play", *scratch / "model"});
    const CommandResult result = run_palpate(arguments);
    EXPECT_EQ(result.status, status) << result.out << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  }

  static std::string press() { return *scratch / "press.csv"; }
  static ScratchFolder* scratch;
};
ScratchFolder* PlayDevice::scratch = nullptr;

TEST_F(PlayDevice, ClosesTheLoopWithAHandAndReplaysIt) {
  const std::string session = *scratch / "s.bin";
  const json run =
      figures({"--device", "hand", "--trajectory", press(), "--session", session, "--record",
               *scratch / "trace.csv", "--exchange", *scratch / "other", "--exchange-at", "0.45"});
  EXPECT_GT(run["stick"], 200);
  EXPECT_GT(run["largest_force"], 0.2);
  // The hand presses with a spring: it gives way, and its path leads 8 mm into the sheet.
  EXPECT_NEAR(run["displacement_on_path"], 8, 0.1);
  EXPECT_LT(run["largest_displacement"].get<double>(),
            0.95 * run["displacement_on_path"].get<double>());
  EXPECT_GT(run["largest_displacement"], 0.5);
  EXPECT_EQ(run["exchanges"], 1);
  EXPECT_GT(run["coupling_stiffness"], 1);
  EXPECT_FALSE(run["real_time"]);
  EXPECT_FALSE(run["memory_locked"]);  // only with --realtime
  EXPECT_EQ(run["safety"]["late"], 0);
  EXPECT_FALSE(read_text(*scratch / "trace.csv").empty());
  const json again = figures({"--replay", session, "--exchange", *scratch / "other"});
  EXPECT_EQ(again["replayed"], run["steps"]);
  EXPECT_EQ(again["different"], 0);
  expect_words({"--replay", session}, kWrongCall, "1 exchanges and needs one more model");

  // A damaged session, and the session of another model.
  std::string bytes = read_text(session);
  bytes[bytes.size() - 100] = static_cast<char>(bytes[bytes.size() - 100] ^ 1);
  write_text(*scratch / "damaged.bin", bytes);
  expect_words({"--replay", *scratch / "damaged.bin", "--exchange", *scratch / "other"},
               kWorkFailed, "differs in 1 of");
  write_text(*scratch / "other/surface.ply", read_text(*scratch / "other/surface.ply") + " ");
  expect_words({"--replay", session, "--exchange", *scratch / "other"}, kWrongCall,
               "is not the model of the session");
}

TEST_F(PlayDevice, SaysHowFarTheHandCameAndWhatItWasGiven) {
  const CommandResult result = run_palpate({"play", *scratch / "model", "--device", "hand",
                                            "--trajectory", press(), "--duration", "0.5"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_NE(result.out.find(
                "no energy was returned to the user\nThe hand gave way: largest displacement "),
            std::string::npos)
      << result.out;
}

TEST_F(PlayDevice, ReadsBinaryTrajectoriesWithAndWithoutADevice) {
  const std::string path = *scratch / "press.bin";
  haptics::write_binary_trajectory(path, haptics::read_trajectory_file(press()));
  EXPECT_EQ(figures({"--trajectory", path})["steps"], 4);
  EXPECT_GT(figures({"--device", "recorded", "--trajectory", path})["steps"], 800);
}

TEST_F(PlayDevice, FollowsTrajectoriesAndHoldsTheArm) {
  const json recorded = figures(
      {"--device", "recorded", "--trajectory", press(), "--no-coupling", "--ramp", "0.001"});
  EXPECT_GT(recorded["largest_force"], 0.2);
  EXPECT_TRUE(recorded["coupling_stiffness"].is_null());
  const json arm = figures({"--device", "arm", "--trajectory", press()});
  EXPECT_GT(arm["stick"].get<int>() + arm["slip"].get<int>(), 200);
}

TEST_F(PlayDevice, RunsADriverInAProcessOfItsOwnInRealTime) {
  const json run = figures({"--device", PALPATE_DOCUMENTED_DEVICE, "--realtime", "--duration",
                            "0.8", "--pose", *scratch / "pose.txt", "--set", "hand=0.3"});
  EXPECT_GT(run["stick"].get<int>() + run["slip"].get<int>(), 20);
  EXPECT_LE(run["rate"], 1010);
  EXPECT_EQ(run["safety"]["no_answer"], 0);
  const json inside = figures({"--device", PALPATE_DOCUMENTED_DEVICE, "--duration", "0.05",
                               "--in-process", "--pose", *scratch / "pose.txt"});
  EXPECT_GT(inside["steps"], 2);
}

TEST_F(PlayDevice, ExchangesTheModelInTheFirstTickAfterItsTimeAlsoInRealTime) {
  const std::string session = *scratch / "exchange.bin";
  fs::copy(*scratch / "model", *scratch / "third", fs::copy_options::recursive);
  const json run = figures({"--device", "hand", "--trajectory", press(), "--realtime", "--session",
                            session, "--exchange", *scratch / "third", "--exchange-at", "0.2"});
  EXPECT_EQ(run["exchanges"], 1);
  double first = -1, before = -1;
  for (const haptics::TickRecord& tick : haptics::read_loop_record(session).ticks) {
    if (first < 0) first = tick.now;
    if ((tick.flags & haptics::TickRecord::kExchanged) != 0) {
      EXPECT_GE(tick.now - first, 0.2);
      EXPECT_LT(before - first, 0.2);
    }
    before = tick.now;
  }
}

TEST_F(PlayDevice, ContainsDriversThatGoWrong) {
  const auto broken = [](const std::string& fault) {
    return std::vector<std::string>{
        "--device", PALPATE_BROKEN_DEVICE, "--set", "fault=" + fault, "--set",
        "at=20",    "--duration",          "0.3"};
  };
  expect_words(broken("crash"), kWorkFailed, "the driver's process crashed: signal 6");
  expect_words({"--device", PALPATE_CRASHING_DEVICE, "--duration", "1"}, kWorkFailed,
               "while the driver was loaded");
  expect_words(broken("hang"), kWorkFailed,
               "it does not answer any more: the driver's process does not answer");
  expect_words(broken("deaf"), kWorkFailed, "it takes no commands any more: broken as told");
  EXPECT_EQ(figures(broken("nan"))["safety"]["state_not_finite"], 1);
}

TEST_F(PlayDevice, SaysWhatADeviceNeeds) {
  const json stability = figures(
      {"--stability", "--set", "mass=0.1", "--set", "damping=0.002", "--set", "stiffness=0"});
  EXPECT_NEAR(stability["passive_stiffness"], 4.0 / 3, 1e-9);
  EXPECT_NEAR(stability["coupling_stiffness"], 2.0 / 3, 1e-9);
  EXPECT_LT(stability["calm_without_coupling"], 2);
  EXPECT_EQ(stability["calm_with_coupling"], 1000);
  const double largest = stability["largest_stiffness"];
  EXPECT_GE(largest, stability["median_stiffness"]);
  for (const json& need : stability["needed_damping"]) {
    EXPECT_NEAR(need["damping_of_largest"], largest * 1.5 / need["rate"].get<double>(), 1e-9);
  }
  const json driver = figures({"--stability", "--device", PALPATE_DOCUMENTED_DEVICE});
  EXPECT_NEAR(driver["passive_stiffness"], 5.0 / 1.5, 1e-9);
}

TEST_F(PlayDevice, RefusesAModelWithTheSurfaceOfAnotherOneAlsoWithoutADevice) {
  const std::string smaller = *scratch / "smaller", mixed = *scratch / "mixed";
  ASSERT_EQ(run_palpate({"transfer", *scratch / "model", "--scale", "0.1", "-o", smaller}).status,
            kDone);
  fs::copy(*scratch / "model", mixed, fs::copy_options::recursive);
  fs::copy_file(smaller + "/surface.ply", mixed + "/surface.ply",
                fs::copy_options::overwrite_existing);
  const CommandResult result = run_palpate({"play", mixed, "--trajectory", press()});
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_NE(result.err.find("mixed: contact 0 lies"), std::string::npos) << result.err;
}

TEST_F(PlayDevice, RefusesCallsWithoutSense) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> calls = {
      {{}, "needs --trajectory, --device, --replay or --stability"},
      {{"--device", "hnad", "--duration", "1"}, "there is no such file"},
      {{"--device", "hand", "--trajectory", press(), "--set", "mas=1"}, "--set mas"},
      {{"--device", "recorded", "--trajectory", press(), "--set", "mass=1"},
       "--device recorded has rate [Hz]"},
      {{"--device", "arm", "--trajectory", press(), "--set", "delay=1"},
       "--device arm has mass [kg], damping [N s/mm], stiffness [N/mm]"},
      {{"--device", "hand", "--trajectory", press(), "--coupling-stiffness", "-1"},
       "--coupling-stiffness: is -1"},
      {{"--device", "hand", "--trajectory", press(), "--record", *scratch / "t.csv"},
       "give --session"},
      {{"--device", "hand", "--trajectory", press(), "--set", "delay=nan"},
       "--set delay is \"nan\"; it must be a whole number in [0, 16]"},
      {{"--device", "hand", "--trajectory", press(), "--exchange-at", "0.3"},
       "--exchange-at requires --exchange"},
      {{"--stability", "--device", "arm"}, "--device is arm"},
  };
  for (const auto& [call, words] : calls) expect_words(call, kWrongCall, words);
}

// Each option with a value, and the beginnings of calls in which it has no effect.
TEST_F(PlayDevice, RefusesEachOptionWhereItDoesNothing) {
  using Words = std::vector<std::string>;
  const Words along = {"--trajectory", press()};
  const Words hand = {"--device", "hand", "--trajectory", press()};
  const Words driver = {"--device", PALPATE_DOCUMENTED_DEVICE};
  const Words replay = {"--replay", "s.bin"};
  const Words stability = {"--stability"};
  struct Idle {
    Words option;
    std::vector<std::pair<Words, std::string>> calls;  // and what it needs
  };
  const std::string device = "it needs --device", a_driver = "it needs the driver of a device";
  const std::vector<Idle> all = {
      {{"--trajectory", press()}, {{driver, ""}, {replay, ""}, {stability, ""}}},
      {{"--record", *scratch / "t.csv"}, {{replay, ""}, {stability, ""}}},
      {{"--picture", *scratch / "t.png"},
       {{hand, ""}, {driver, ""}, {replay, ""}, {stability, ""}}},
      {{"--device", "hand"}, {{replay, ""}}},
      {{"--stability"}, {{replay, ""}}},
      {{"--set", "mass=1"}, {{along, device}, {replay, ""}}},
      {{"--device-number", "0"},
       {{along, a_driver}, {hand, a_driver}, {replay, ""}, {stability, a_driver}}},
      {{"--in-process"},
       {{along, a_driver}, {hand, a_driver}, {replay, ""}, {stability, a_driver}}},
      {{"--clutch-button", "1"},
       {{along, a_driver}, {hand, a_driver}, {replay, ""}, {stability, a_driver}}},
      {{"--realtime"}, {{along, device}, {replay, device}, {stability, device}}},
      {{"--duration", "1"}, {{along, device}, {replay, device}, {stability, device}}},
      {{"--session", *scratch / "s.bin"}, {{along, device}, {replay, device}, {stability, device}}},
      {{"--pose", *scratch / "pose.txt"}, {{along, device}, {replay, device}, {stability, device}}},
      {{"--scale", "2"}, {{along, device}, {replay, device}}},
      {{"--no-coupling"}, {{along, device}, {replay, device}}},
      {{"--max-force", "3.3"}, {{along, device}, {replay, device}}},
      {{"--slew", "1000"}, {{along, device}, {replay, device}, {stability, device}}},
      {{"--ramp", "0.5"}, {{along, device}, {replay, device}, {stability, device}}},
      {{"--lease", "0.01"}, {{along, device}, {replay, device}, {stability, device}}},
      {{"--exchange", *scratch / "other"}, {{along, device}, {stability, device}}},
      {{"--exchange", *scratch / "other", "--exchange-at", "1"}, {{replay, device}}},
  };
  for (const Idle& idle : all) {
    for (const auto& [begin, needs] : idle.calls) {
      Words call = begin;
      call.insert(call.end(), idle.option.begin(), idle.option.end());
      // The last option that was given here is the one without effect.
      const std::string name = idle.option.size() > 2 ? idle.option[2] : idle.option[0];
      call.insert(call.begin(), {"play", *scratch / "model"});
      const CommandResult result = run_palpate(call);
      EXPECT_EQ(result.status, kWrongCall) << result.out;
      EXPECT_NE(result.err.find(name + ": does nothing "), std::string::npos) << result.err;
      EXPECT_NE(result.err.find(needs), std::string::npos) << result.err;
    }
  }
}

}  // namespace
}  // namespace palpate::apps
