// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/project_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

constexpr const char* kProjectRecord = "record of palpate run";
// Of the record; raised when the meaning of a member changes.
constexpr int kProjectRecordVersion = 1;

constexpr std::array<const char*, 3> kStates = {"begun", "failed", "done"};

StepState to_state(const std::string& word) {
  const auto* const found = std::ranges::find(kStates, word);
  if (found != kStates.end()) return static_cast<StepState>(found - kStates.begin());
  throw std::out_of_range("state is " + word);
}

Json to_json(const StepRecord& record) {
  return {{"state", kStates.at(static_cast<std::size_t>(record.state))},
          {"palpate", record.version},
          {"entries", record.entries},
          {"inputs", record.inputs},
          {"writes", record.writes},
          {"outputs", record.outputs},
          {"shards", record.shards},
          {"jobs", record.jobs},
          {"seconds", record.seconds},
          {"figures", record.figures}};
}

StepRecord to_record(const Json& json) {
  return {.state = to_state(json.at("state")),
          .version = json.at("palpate"),
          .entries = json.at("entries"),
          .inputs = json.at("inputs"),
          .writes = json.at("writes"),
          .outputs = json.at("outputs"),
          .shards = json.value("shards", 0),
          .jobs = json.value("jobs", std::vector<std::string>()),
          .seconds = json.at("seconds"),
          .figures = json.at("figures")};
}

std::string to_text(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

ProjectRecord::ProjectRecord(fs::path file) : file_(std::move(file)) {
  if (!is_there(file_)) return;
  try {
    std::ifstream stream(file_, std::ios::binary);
    const Json json = Json::parse(stream);
    if (json.at("kind") != kProjectRecord || json.at("version") != kProjectRecordVersion)
      throw FileError(file_.string() + ": is a record of another program or version.");
    for (const auto& [step, record] : json.at("steps").items()) steps_[step] = to_record(record);
  } catch (const FileError&) {
    throw;
  } catch (const std::exception& error) {  // of JSON, or an unknown state
    throw FileError(fmt::format(
        "{}: is not a record of palpate run ({}). Without it nothing is known of the results "
        "beside it: to start again, move this file and the results elsewhere.",
        file_.string(), error.what()));
  }
}

const StepRecord* ProjectRecord::find(const std::string& step) const {
  const auto found = steps_.find(step);
  return found == steps_.end() ? nullptr : &found->second;
}

void ProjectRecord::put(const std::string& step, StepRecord record) {
  steps_[step] = std::move(record);
  Json steps = Json::object();
  for (const auto& [name, known] : steps_) steps[name] = to_json(known);
  write_file(file_, [&](std::ostream& out) {
    out << to_text(
        {{"kind", kProjectRecord}, {"version", kProjectRecordVersion}, {"steps", steps}});
  });
}

}  // namespace palpate::apps
