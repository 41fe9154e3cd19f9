// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/device_record.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "palpate/core/error.h"
#include "probing_arm.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::devices {
namespace {

using Eigen::Vector3d;

const std::shared_ptr<const probing::Specimen> kRecordedBody =
    probing::make_specimen(probing::ElasticBody{.young_modulus = 0.2, .friction = 0.7});

probing::TrialOrder recorded_order(long long trial, double force = 0.4) {
  return probing::support::pull_at(trial, {10, 5, 700}, {0, 0, -1}, force, 0.1);
}

class ArmRecord : public ::testing::Test {
 protected:
  /// Two trials, recorded.
  void SetUp() override {
    probing::VirtualArm arm(kRecordedBody.get(), probing::support::virtual_arm_for(options));
    RecordingDevice recorder(arm, file, "a session");
    probing::ArmProber prober(recorder, options, nullptr, probing::support::measured_gravity());
    for (probing::TrialResult& each : results)
      each = run_trial(prober, recorded_order(trial++), {});
    recorder.flush();
  }
  probing::TrialResult replayed(ReplayDevice& arm, long long which, double force = 0.4) {
    probing::ArmProber prober(arm, options, nullptr, probing::support::measured_gravity());
    return run_trial(prober, recorded_order(which, force), {});
  }

  ScratchFolder folder;
  std::filesystem::path file = folder / "session.arm";
  probing::ArmProberOptions options = probing::support::prober_over(*kRecordedBody);
  probing::TrialResult results[2];
  long long trial = 0;
};

TEST_F(ArmRecord, GivesTheSameMeasurementsAgain) {
  ReplayDevice arm(file);
  EXPECT_EQ(arm.session(), "a session");
  EXPECT_EQ(arm.description().name, "virtual arm");
  EXPECT_FALSE(arm.description().real_time);
  probing::ArmProber prober(arm, options, nullptr, probing::support::measured_gravity());
  for (int i = 0; i < 2; ++i) {
    const probing::TrialResult again = run_trial(prober, recorded_order(i), {});
    EXPECT_EQ(again.outcome, probing::TrialOutcome::held);
    EXPECT_EQ(again.touch, results[i].touch);
    EXPECT_EQ(again.a, results[i].a);
    EXPECT_EQ(again.b, results[i].b);
    EXPECT_EQ(again.a_again, results[i].a_again);
    EXPECT_EQ(again.seconds, results[i].seconds);
  }
}

TEST_F(ArmRecord, GoesOnAtTheTrialThatIsAskedFor) {
  ReplayDevice arm(file);
  EXPECT_EQ(replayed(arm, 1).b, results[1].b);
  EXPECT_EQ(replayed(arm, 0).b, results[0].b);
}

TEST_F(ArmRecord, HoldsTheReferenceForceIfThereIsOne) {
  ReplayDevice arm(file);
  EXPECT_TRUE(arm.description().measures_reference);
  probing::ArmProber prober(arm, options, nullptr, probing::support::measured_gravity());
  static_cast<void>(run_trial(prober, recorded_order(0), {}));
  ASSERT_EQ(prober.applied_forces().size(), 3u);  // press, drag, release
  for (const probing::AppliedForce& each : prober.applied_forces()) {
    EXPECT_LT((each.reference - each.commanded).norm(), 0.05);
    EXPECT_GT(each.internal.norm(), 0.005);  // friction of the joints is 0.05 N at the tip
  }
}

TEST_F(ArmRecord, OfVersion1IsReplayedWithoutAReferenceForce) {
  // A state of that version: one clock reading, one state of 13 numbers, another clock reading.
  const std::filesystem::path old = folder / "old.arm";
  std::ofstream out(old, std::ios::binary);
  out << R"({"format": "palpate arm record", "version": 1, "name": "old", "period": 0.001, )"
      << R"("highest_force": 3, "continuous_force": 1, "measures_joints": true, )"
      << R"("measures_force": true, "measures_heat": true, "session": ""})" << '\n';
  const auto put = [&](char letter, int first, int count) {
    out.put(letter);
    for (int i = 0; i < count; ++i) {
      const double number = first + i;
      out.write(reinterpret_cast<const char*>(&number), sizeof(number));
    }
  };
  put('N', 7, 1);
  put('R', 1, 13);
  put('N', 8, 1);
  out.close();
  ReplayDevice arm(old);
  EXPECT_FALSE(arm.description().measures_reference);
  EXPECT_EQ(arm.now(), 7);
  DeviceState state;
  ASSERT_TRUE(arm.read(state));
  EXPECT_EQ(state.time, 1);
  EXPECT_EQ(state.heat, Vector3d(11, 12, 13));
  EXPECT_TRUE(state.reference_force.hasNaN());
  EXPECT_EQ(arm.now(), 8);
}

TEST_F(ArmRecord, StopsWhereTheProgramCommandsSomethingElse) {
  ReplayDevice arm(file);
  try {
    static_cast<void>(replayed(arm, 0, 0.41));
    FAIL() << "a result came out";
  } catch (const probing::ArmStopped& stopped) {
    EXPECT_EQ(stopped.fault, DeviceFault::no_answer);
    EXPECT_NE(std::string(stopped.what()).find("another force was commanded here"),
              std::string::npos)
        << stopped.what();
  }
}

TEST_F(ArmRecord, StopsAtTheEndOfARecordThatWasCutOff) {
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 3);
  ReplayDevice arm(file);
  try {
    static_cast<void>(replayed(arm, 0));
    FAIL() << "a result came out";
  } catch (const probing::ArmStopped& stopped) {
    EXPECT_NE(std::string(stopped.what()).find("the record ends here"), std::string::npos)
        << stopped.what();
  }
}

TEST_F(ArmRecord, RefusesWhatIsNoRecord) {
  const auto refused = [&](const std::string& text) {
    std::ofstream(folder / "other") << text;
    return refusal([&] { return ReplayDevice(folder / "other").now(); });
  };
  EXPECT_NE(refused("id,x,y\n").find("is no record of an arm"), std::string::npos);
  EXPECT_NE(refused("").find("is no record of an arm"), std::string::npos);
  EXPECT_NE(refused(R"({"format": "palpate arm record", "version": 3})"
                    "\n")
                .find("version 3; this program reads 1 to 2"),
            std::string::npos);
  EXPECT_NE(refused(R"({"format": "palpate arm record", "version": 1})"
                    "\n")
                .find("its first line is damaged"),
            std::string::npos);
  EXPECT_NE(refusal([&] { return ReplayDevice(folder / "missing").now(); }).find("cannot be read"),
            std::string::npos);
  probing::VirtualArm arm(nullptr);
  EXPECT_THROW(RecordingDevice(arm, folder / "no folder" / "file"), OutputError);
}

TEST_F(ArmRecord, ADiskThatIsFullIsNoticedAtTheEnd) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  probing::VirtualArm arm(nullptr);
  RecordingDevice recorder(arm, "/dev/full");
  DeviceState state;
  ASSERT_TRUE(recorder.read(state));
  EXPECT_THROW(recorder.flush(), OutputError);
}

}  // namespace
}  // namespace palpate::devices
