// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/campaign_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>

#include "campaign/campaign_testing.h"
#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/fingerprint.h"
#include "scratch_folder.h"

namespace palpate::probing {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

class CampaignStoreTest : public ::testing::Test {
 protected:
  CampaignDescription description() const {
    return {.plan = to_text(plan), .strategy = to_text(options), .arm = "{}", .software = "test"};
  }
  fs::path path(const std::string& name = "a.db") const { return folder.path() / name; }

  /// Goes on with the campaign in a store until it is complete, or for some trials.
  void go_on(CampaignStore store, int most = 1 << 20) const {
    Campaign campaign(plan, options);
    for (const TrialRecord& record : store.trials(plan.contacts)) (void)campaign.take(record);
    const auto arm = make_quasi_static_arm(sheet);
    for (int i = 0; i < most && campaign.next(); ++i) {
      const double time = campaign.progress().seconds;
      const TrialRecord record{*campaign.next(), run_trial(*arm, *campaign.next(), {})};
      store.append(record, campaign.take(record), time);
    }
    if (!campaign.next()) store.finish();
  }

  std::string print_of(const fs::path& store) const {
    return fingerprint(read_acquisition(store).records());
  }

  const std::shared_ptr<const Specimen> sheet = make_specimen(Sheet{});
  const ContactPlan plan = support::small_plan(*sheet, 3);
  const CampaignOptions options = {};
  const ScratchFolder folder;
};

template <typename Call>
std::string refused(Call call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST_F(CampaignStoreTest, KeepsWhatTheArmRemembersAfterTheLatestTrial) {
  Campaign campaign(plan, options);
  const auto arm = make_quasi_static_arm(sheet);
  {
    CampaignStore store = CampaignStore::create(path(), description());
    EXPECT_EQ(store.memory(), "");
    for (const char* memory : {"first", "second", ""}) {
      const TrialRecord record{*campaign.next(), run_trial(*arm, *campaign.next(), {})};
      store.append(record, campaign.take(record), 0, memory);
    }
  }
  const CampaignStore again = CampaignStore::open(path());
  EXPECT_EQ(again.memory(), "second");
  EXPECT_EQ(again.trials(plan.contacts).size(), 3U);
}

TEST_F(CampaignStoreTest, GivesBackTrialsToTheLastBit) {
  CampaignStore store = CampaignStore::create(path(), description());
  Campaign campaign(plan, options);
  const auto arm = make_quasi_static_arm(sheet);
  std::vector<TrialRecord> records = support::perform(campaign, *arm, options, 12);
  records.back().result.outcome = TrialOutcome::no_contact;
  records.front().result.creep = 0.1;
  records.front().result.work_dragging = 1.0 / 3;
  records.front().result.work_releasing = -1.0 / 7;
  records.back().result.a.setConstant(std::numeric_limits<double>::quiet_NaN());
  for (const TrialRecord& record : records) store.append(record, {}, 1);
  const std::vector<TrialRecord> read = store.trials(plan.contacts);
  ASSERT_EQ(read.size(), records.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].order.trial, records[i].order.trial);
    EXPECT_EQ(read[i].order.contact.position, records[i].order.contact.position);
    EXPECT_EQ(read[i].order.level, records[i].order.level);
    EXPECT_EQ(read[i].order.direction, records[i].order.direction);
    EXPECT_EQ(read[i].order.normal_force, records[i].order.normal_force);
    EXPECT_EQ(read[i].order.tangential_force, records[i].order.tangential_force);
    EXPECT_EQ(read[i].result.outcome, records[i].result.outcome);
    EXPECT_EQ(read[i].result.b, records[i].result.b);
    EXPECT_EQ(read[i].result.seconds, records[i].result.seconds);
  }
  EXPECT_FALSE(read.back().result.a.allFinite());
  EXPECT_EQ(read.front().result.creep, 0.1);
  EXPECT_EQ(read.front().result.work_dragging, 1.0 / 3);
  EXPECT_EQ(read.front().result.work_releasing, -1.0 / 7);
  EXPECT_TRUE(std::isnan(read[1].result.work_dragging));  // the quasi-static arm knows no path
  EXPECT_EQ(store.description().plan, to_text(plan));
  EXPECT_EQ(store.description().strategy, to_text(options));
  EXPECT_EQ(to_text(parse_campaign_options(to_text(options), "a.db")), to_text(options));
}

TEST_F(CampaignStoreTest, GivesBackReferenceProbesToTheLastBit) {
  CampaignStore store = CampaignStore::create(path(), description());
  const auto arm = make_quasi_static_arm(sheet);
  std::vector<ReferenceProbe> probes;
  for (long long i = 0; i < 3; ++i) {
    const TrialOrder order = reference_order(plan, i);
    probes.push_back(
        {.number = i, .trials = 50 * i, .time = 600.5, .result = run_trial(*arm, order, {})});
    if (i == 2) probes[2].result.a.setConstant(std::nan(""));
    if (i == 2) probes[2].result.outcome = TrialOutcome::no_contact;
    store.append(probes.back(), order, "after " + std::to_string(i));
  }
  const std::vector<ReferenceProbe> read = CampaignStore::look(path()).references();
  ASSERT_EQ(read.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read[i].number, probes[i].number);
    EXPECT_EQ(read[i].trials, probes[i].trials);
    EXPECT_EQ(read[i].time, probes[i].time);
    EXPECT_EQ(read[i].result.outcome, probes[i].result.outcome);
    EXPECT_EQ(read[i].result.touch, probes[i].result.touch);
    EXPECT_EQ(read[i].result.seconds, probes[i].result.seconds);
  }
  EXPECT_EQ(read[1].result.a, probes[1].result.a);
  EXPECT_FALSE(read[2].result.a.allFinite());
  EXPECT_EQ(store.memory(), "after 2");
  EXPECT_TRUE(CampaignStore::look(path()).trials(plan.contacts).empty());  // they are no trials
}

TEST_F(CampaignStoreTest, GoesOnWithAStoreThatWasBegunWithoutReferenceProbes) {
  { CampaignStore store = CampaignStore::create(path(), description()); }
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(path().c_str(), &raw), SQLITE_OK);
  sqlite3_exec(raw, "DROP TABLE reference_probe", nullptr, nullptr, nullptr);
  sqlite3_close(raw);
  EXPECT_TRUE(CampaignStore::look(path()).references().empty());
  go_on(CampaignStore::open(path()), 2);
  CampaignStore store = CampaignStore::open(path());
  store.append(ReferenceProbe{}, reference_order(plan, 0));
  EXPECT_EQ(store.references().size(), 1U);
  std::string text = to_text(options);
  const std::string member = ",\"reference_every\":50";
  ASSERT_NE(text.find(member), std::string::npos) << text;
  text.erase(text.find(member), member.size());
  EXPECT_EQ(parse_campaign_options(text, "a.db").reference_every, 0);
}

TEST_F(CampaignStoreTest, TellsWhyATrialFailed) {
  CampaignStore store = CampaignStore::create(path(), description());
  Campaign campaign(plan, options);
  TrialRecord record{*campaign.next(), {}};
  record.result.outcome = TrialOutcome::unsettled;
  record.result.reason = "the object has no equilibrium: path_blocked beyond 1 N";
  TrialVerdict verdict;
  verdict.contact_given_up = true;
  store.append(record, verdict, 0);
  record.order.trial = 1;
  record.result.reason = "";  // it only takes too long
  store.append(record, {}, 10);
  store.note("arm_stopped", "cable");
  const std::vector<CampaignEvent> events = store.events();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0].trial, 0);
  EXPECT_EQ(events[0].kind, "no_equilibrium");
  EXPECT_EQ(events[0].text, "contact 0: the object has no equilibrium: path_blocked beyond 1 N");
  EXPECT_EQ(events[1].kind, "contact_given_up");
  EXPECT_EQ(events[2].kind, "arm_stopped");
  EXPECT_EQ(events[2].trial, 1);
}

TEST_F(CampaignStoreTest, KeepsTheRangeMapOfASampleOrWhyThereIsNone) {
  CampaignDescription with_camera = description();
  with_camera.camera = R"({"camera": "simulated"})";
  CampaignStore store = CampaignStore::create(path(), with_camera);
  fs::create_directory(path("range"));
  write_text(path("range/000000.tiff").string(), "depths");
  Campaign campaign(plan, options);
  const auto arm = make_quasi_static_arm(sheet);
  for (int i = 0; i < 2; ++i) {
    TrialRecord record{*campaign.next(), run_trial(*arm, *campaign.next(), {})};
    (i == 0 ? record.result.range_map : record.result.no_range_map) =
        i == 0 ? "range/000000.tiff" : "dark";
    store.append(record, campaign.take(record), i);
  }
  EXPECT_EQ(store.range_maps(), 1);
  EXPECT_THAT(store.range_map_fingerprints(),
              ElementsAre(Pair("range/000000.tiff", text_fingerprint("depths"))));
  const CampaignStore again = CampaignStore::look(path());
  EXPECT_EQ(again.description().camera, with_camera.camera);
  const CheckedAcquisition acquisition = read_acquisition(path());
  EXPECT_EQ(acquisition.samples()[0].range_map, "range/000000.tiff");
  EXPECT_FALSE(acquisition.samples()[1].range_map.has_value());
  ASSERT_EQ(again.events().size(), 1U);
  EXPECT_EQ(again.events()[0].trial, 1);
  EXPECT_EQ(again.events()[0].kind, "no_range_map");
  EXPECT_EQ(again.events()[0].text, "contact 0: dark");
}

TEST_F(CampaignStoreTest, IsAnAcquisitionAtAnyTime) {
  CampaignDescription with_ball = description();
  with_ball.probe_radius = 2.5;
  CampaignStore store = CampaignStore::create(path(), with_ball);
  go_on(std::move(store), 9);
  EXPECT_EQ(read_acquisition(path()).samples().size(), 9U);
  EXPECT_EQ(read_acquisition(path()).records().probe_radius, 2.5);
  go_on(CampaignStore::open(path()));
  const CheckedAcquisition acquisition = read_acquisition(path());
  EXPECT_EQ(acquisition.contacts().size(), 3U);
  EXPECT_GT(acquisition.samples().size(), 60U);
  int on_boundary = 0;
  for (const Sample& sample : acquisition.samples()) on_boundary += sample.on_friction_boundary;
  EXPECT_GT(on_boundary, 5);
  EXPECT_FALSE(fs::exists(path().string() + "-wal"));
}

TEST_F(CampaignStoreTest, CanBeReadWhileACampaignWrites) {
  CampaignStore store = CampaignStore::create(path(), description());
  Campaign campaign(plan, options);
  const auto arm = make_quasi_static_arm(sheet);
  for (int i = 0; i < 20; ++i) {
    const TrialRecord record{*campaign.next(), run_trial(*arm, *campaign.next(), {})};
    store.append(record, campaign.take(record), i);
    EXPECT_EQ(read_acquisition(path()).samples().size(), static_cast<std::size_t>(i + 1));
    EXPECT_EQ(CampaignStore::look(path()).trials(plan.contacts).size(),
              static_cast<std::size_t>(i + 1));
  }
}

TEST_F(CampaignStoreTest, IsFinishedAlsoWhileAnotherProcessReadsIt) {
  CampaignStore store = CampaignStore::create(path(), description());
  sqlite3* reader = nullptr;
  ASSERT_EQ(sqlite3_open(path().c_str(), &reader), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(reader, "BEGIN; SELECT count(*) FROM trial", nullptr, nullptr, nullptr),
            SQLITE_OK);
  go_on(std::move(store));
  sqlite3_close(reader);
  EXPECT_GT(read_acquisition(path()).samples().size(), 60U);
}

// Processes that are killed at any moment, and go on: as one that was not.
TEST_F(CampaignStoreTest, AfterKillsIsThatOfAnUninterruptedRun) {
  go_on(CampaignStore::create(path("whole.db"), description()));
  { CampaignStore store = CampaignStore::create(path(), description()); }
  int kills = 0;
  for (int wait = 3000; wait < 60000; wait += 4001) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      go_on(CampaignStore::open(path()));
      ::_exit(0);
    }
    ::usleep(static_cast<useconds_t>(wait));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    kills += WIFSIGNALED(status) ? 1 : 0;
  }
  EXPECT_GT(kills, 3);
  go_on(CampaignStore::open(path()));
  EXPECT_EQ(print_of(path()), print_of(path("whole.db")));
}

// A full disk looks to a process like a limit of the file size.
TEST_F(CampaignStoreTest, AfterAFullDiskGoesOn) {
  go_on(CampaignStore::create(path("whole.db"), description()));
  { CampaignStore store = CampaignStore::create(path(), description()); }
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{150000, 150000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const std::string message = refused([&] { go_on(CampaignStore::open(path())); });
    const bool says = message.find(path().string() + ": ") != std::string::npos &&
                      message.find("; free some space") != std::string::npos;
    ::_exit(says ? 7 : 8);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  const std::size_t kept = CampaignStore::look(path()).trials(plan.contacts).size();
  EXPECT_GT(kept, 3U);
  go_on(CampaignStore::open(path()));
  EXPECT_EQ(print_of(path()), print_of(path("whole.db")));
}

TEST_F(CampaignStoreTest, HasOneWriter) {
  const CampaignStore store = CampaignStore::create(path(), description());
  EXPECT_THAT(refused([&] { (void)CampaignStore::open(path()); }),
              HasSubstr("another process writes into it"));
  EXPECT_THAT(refused([&] { (void)CampaignStore::create(path(), description()); }),
              HasSubstr("exists already"));
}

// A privileged user may write into files that are read-only.
TEST_F(CampaignStoreTest, AReadOnlyStoreCanBeLookedAtAndIsNotOpened) {
  go_on(CampaignStore::create(path(), description()));
  fs::permissions(folder.path(), fs::perms{0755});
  fs::permissions(path(), fs::perms{0444});
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (::geteuid() == 0 && ::setuid(kNobody) != 0) ::_exit(9);
    const std::string message = refused([&] { (void)CampaignStore::open(path()); });
    const bool named = message == path().string() + ": cannot be written: Permission denied";
    const bool looks = !CampaignStore::look(path()).trials(plan.contacts).empty();
    ::_exit(named && looks ? 7 : 8);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST_F(CampaignStoreTest, RefusesWhatIsNoCampaignOrANewerOne) {
  EXPECT_THAT(refused([&] { (void)CampaignStore::open(path()); }), HasSubstr("no such file"));
  Acquisition acquisition;
  acquisition.contacts.push_back(plan.contacts[0]);
  write_acquisition(path(), acquisition);
  EXPECT_THAT(refused([&] { (void)CampaignStore::open(path()); }), HasSubstr("holds no campaign"));
  EXPECT_THAT(refused([&] { (void)CampaignStore::look(path()); }), HasSubstr("holds no campaign"));
  { const CampaignStore store = CampaignStore::create(path("b.db"), description()); }
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(path("b.db").c_str(), &raw), SQLITE_OK);
  sqlite3_exec(raw, "PRAGMA user_version = 3", nullptr, nullptr, nullptr);
  sqlite3_close(raw);
  EXPECT_THAT(refused([&] { (void)CampaignStore::open(path("b.db")); }),
              HasSubstr("is of version 3, newer than this program"));
  EXPECT_THAT(refused([&] { (void)CampaignStore::create("/proc/a.db", description()); }),
              HasSubstr("/proc/a.db"));
}

TEST_F(CampaignStoreTest, RefusesTrialsOfOtherContacts) {
  go_on(CampaignStore::create(path(), description()), 3);
  EXPECT_THAT(refused([&] { (void)CampaignStore::look(path()).trials({{.id = 9}}); }),
              HasSubstr("a trial is of contact 0, which the plan does not have"));
}

}  // namespace
}  // namespace palpate::probing
