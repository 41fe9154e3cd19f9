// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate fit` that is interrupted and resumed.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class FitResume : public ::testing::Test {
 protected:
  static constexpr int kContacts = 6;

  void SetUp() override {
    write_text(scratch / "contacts.csv",
               lines_below(read_text(demo("sheet/contacts.csv")), 0, kContacts));
    write_text(scratch / "samples.csv",
               lines_below(read_text(demo("sheet/samples.csv")), 1, kContacts));
    ASSERT_EQ(run_palpate({"probe", "import", scratch / "contacts.csv", scratch / "samples.csv",
                           "-o", scratch / "a.db"})
                  .status,
              kDone);
  }

  CommandResult fit(const std::string& output, std::vector<std::string> more = {},
                    const CommandOptions& options = {}) const {
    std::vector<std::string> call = {"fit", scratch / "a.db", demo("sheet/surface.ply"),
                                     "-o",  scratch / output, "--json"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call, options);
  }

  // The record of a run that ended in the middle. A fit is quick: one thread leaves enough time.
  void interrupt() const {
    const CommandResult result =
        fit("model", {"--threads", "1"}, {.interrupt_when_there_is = scratch / "model.fits"});
    ASSERT_EQ(result.status, kInterrupted) << result.err;
    ASSERT_TRUE(fs::exists(scratch / "model.fits"));
    ASSERT_FALSE(fs::exists(scratch / "model"));
  }

  ScratchFolder scratch;
};

TEST_F(FitResume, GivesWhatAnUninterruptedRunGives) {
  const CommandResult whole = fit("whole");
  ASSERT_EQ(whole.status, kDone) << whole.err;
  EXPECT_FALSE(fs::exists(scratch / "whole.fits"));
  interrupt();
  // As if it was killed in the middle of a line.
  const std::string record = read_text(scratch / "model.fits");
  write_text(scratch / "model.fits", record + R"({"contact":7,"fit":{"ba)");
  const CommandResult rest = fit("model", {"--resume"});
  ASSERT_EQ(rest.status, kDone) << rest.err;
  for (const char* file : {"field.json", "surface.ply", "contacts.ply"}) {
    EXPECT_EQ(read_text(fs::path(scratch / "model") / file),
              read_text(fs::path(scratch / "whole") / file))
        << file;
  }
  json figures = json::parse(rest.out);
  EXPECT_GE(figures["kept"], 1);
  EXPECT_EQ(figures["kept"], std::count(record.begin(), record.end(), '\n') - 1);
  json expected = json::parse(whole.out);
  figures["kept"] = expected["kept"];
  figures["file"] = expected["file"];
  EXPECT_EQ(figures, expected);
  EXPECT_FALSE(fs::exists(scratch / "model.fits"));
}

TEST_F(FitResume, KeepsTheFitsOfTheRecord) {
  interrupt();
  // A fit that no run would find shows that it was taken over.
  std::string record = read_text(scratch / "model.fits");
  std::istringstream lines(record);
  std::string head, line;
  std::getline(lines, head);
  std::getline(lines, line);
  json entry = json::parse(line);
  entry["fit"]["rms"] = 0.125;
  write_text(scratch / "model.fits", head + "\n" + entry.dump() + "\n");
  const CommandResult rest = fit("model", {"--resume"});
  ASSERT_EQ(rest.status, kDone) << rest.err;
  const json figures = json::parse(rest.out);
  EXPECT_EQ(figures["kept"], 1);
  for (const nlohmann::json& contact : figures["per_contact"]) {
    EXPECT_EQ(contact["rms"] == 0.125, contact["contact"] == entry["contact"]);
  }
}

TEST_F(FitResume, WritesNoModelIfTheErrorsOfAFitExceedItsForces) {
  interrupt();
  const std::string record = read_text(scratch / "model.fits");
  std::istringstream lines(record);
  std::string head, line;
  std::getline(lines, head);
  std::getline(lines, line);
  json entry = json::parse(line);
  // Largest forces are 3.3 N. NaN is written as text.
  for (const json& rms : {json(531600.0), json("nan")}) {
    entry["fit"]["rms"] = rms;
    write_text(scratch / "model.fits", head + "\n" + entry.dump() + "\n");
    const CommandResult result = fit("model", {"--resume"});
    EXPECT_EQ(result.status, kWorkFailed) << result.err;
    EXPECT_NE(result.err.find("the fit failed at 1 of 6 contacts"), std::string::npos)
        << result.err;
    EXPECT_NE(result.err.find("Contacts: " + entry["contact"].dump() + "."), std::string::npos);
    EXPECT_TRUE(result.out.empty());
    EXPECT_FALSE(fs::exists(scratch / "model"));
    EXPECT_FALSE(fs::exists(scratch / "model.fits"));
  }
}

TEST_F(FitResume, RefusesOtherSettingsDataAndRecords) {
  interrupt();
  const std::string record = read_text(scratch / "model.fits");
  const auto refusal = [&](const std::vector<std::string>& more) {
    const CommandResult result = fit("model", more);
    EXPECT_EQ(result.status, kWrongCall);
    EXPECT_FALSE(fs::exists(scratch / "model"));
    return result.err;
  };
  EXPECT_NE(refusal({"--resume", "--accuracy", "0.02"}).find("another --accuracy"),
            std::string::npos);
  EXPECT_NE(refusal({"--resume", "--unit", "cm"}).find("another --unit"), std::string::npos);
  EXPECT_EQ(read_text(scratch / "model.fits"), record);
  // An unreadable record is reported, and not guessed.
  const std::size_t end_of_head = record.find('\n');
  json head = json::parse(record.substr(0, end_of_head));
  head.erase("version");
  write_text(scratch / "model.fits", head.dump() + record.substr(end_of_head));
  EXPECT_NE(refusal({"--resume"}).find("another version of palpate"), std::string::npos);
  const auto with_fit = [&](const char* member, const json& value) {
    const std::size_t end = record.find('\n', end_of_head + 1);
    json entry = json::parse(record.substr(end_of_head + 1, end - end_of_head - 1));
    entry["fit"][member] = value;
    write_text(scratch / "model.fits",
               record.substr(0, end_of_head + 1) + entry.dump() + record.substr(end));
  };
  with_fit("passivity", 0);
  EXPECT_NE(refusal({"--resume"}).find("is not the record of an earlier run"), std::string::npos);
  with_fit("mode", "concave");
  EXPECT_NE(refusal({"--resume"}).find("concave"), std::string::npos);
  with_fit("bases", {{1, 0, 0, 0, 0, 0, 0, 0}, {2, 1, 0, 0, 0, 0, 0, 0}});
  EXPECT_NE(refusal({"--resume"}).find("a field: base 0: epsilon"), std::string::npos);
  write_text(scratch / "model.fits", "{}\n");
  EXPECT_NE(refusal({"--resume"}).find("is not the record of an earlier run"), std::string::npos);
  write_text(scratch / "model.fits", "a letter\n");
  EXPECT_NE(refusal({}).find("is no record"), std::string::npos);
  EXPECT_EQ(read_text(scratch / "model.fits"), "a letter\n");

  write_text(scratch / "model.fits", record);
  std::string samples = read_text(scratch / "samples.csv");
  samples.replace(samples.rfind("0.0"), 3, "0.1");
  write_text(scratch / "samples.csv", samples);
  ASSERT_EQ(run_palpate({"probe", "import", scratch / "contacts.csv", scratch / "samples.csv", "-o",
                         scratch / "a.db"})
                .status,
            kDone);
  EXPECT_NE(refusal({"--resume"}).find("another ACQUISITION"), std::string::npos);
  // Without --resume all are fitted again.
  EXPECT_EQ(fit("model").status, kDone);
  EXPECT_FALSE(fs::exists(scratch / "model.fits"));
}

}  // namespace
}  // namespace palpate::apps
