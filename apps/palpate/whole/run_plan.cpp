// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/run_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/core/file_names.h"
#include "shards/shard_journal.h"
#include "shared/inputs.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

using nlohmann::json;

/// Texts as they come back from a JSON file, which is UTF-8; names of files need not be.
json in_utf8(const json& texts) {
  return json::parse(texts.dump(-1, ' ', false, json::error_handler_t::replace));
}

bool counts(const fs::path& file) { return !is_hidden(file) && file.extension() != ".jsonl"; }

/// Journals record when and by which host shards were made.
bool holds_journals(const fs::path& folder) {
  return is_there(folder / call_file({}).filename()) &&
         folder.filename() == call_file({}).parent_path();
}

void add_file(const fs::path& file, Fingerprints& files) {
  files[in_utf8(file.generic_string())] = file_fingerprint(file);
}

void add_folder(const fs::path& folder, Fingerprints& files) {
  for (auto at = fs::recursive_directory_iterator(folder); at != fs::recursive_directory_iterator();
       ++at) {
    if (at->is_directory()) {
      if (is_hidden(at->path()) || holds_journals(at->path())) at.disable_recursion_pending();
    } else if (at->is_regular_file() && counts(at->path())) {
      add_file(at->path(), files);
    }
  }
}

/// Files that are read with a range map.
std::vector<fs::path> files_beside(const fs::path& file) {
  if (!is_range_map(file)) return {};
  std::vector<fs::path> beside = {file.parent_path() / "rig.yaml"};
  for (const char* ending : {"_sigma.tiff", "_noise.tiff", "_reasons.tiff", "_color.png"})
    beside.push_back(file.parent_path() / (file.stem().string() + ending));
  return beside;
}

/// "0.2", or "0.2, 0.3" of several.
std::string values_in_words(const json& values) {
  std::vector<std::string> words;
  for (const json& given : values)
    for (const json& word : given) words.push_back(word.get<std::string>());
  return fmt::format("{}", fmt::join(words, ", "));
}

void compare_entries(const json& before, const json& now, std::vector<std::string>& changes) {
  for (const auto& [name, values] : now.items()) {
    if (!before.contains(name))
      changes.push_back(name + " is new");
    else if (before[name] != values)
      changes.push_back(fmt::format("{} was {}, is {}", name, values_in_words(before[name]),
                                    values_in_words(values)));
  }
  for (const auto& [name, values] : before.items())
    if (!now.contains(name)) changes.push_back(name + " is left out");
}

void compare_files(const Fingerprints& before, const Fingerprints& now,
                   std::vector<std::string>& changes) {
  for (const auto& [path, content] : now) {
    const auto earlier = before.find(path);
    if (earlier == before.end())
      changes.push_back(path + " is new");
    else if (earlier->second != content)
      changes.push_back(path + " changed");
  }
  for (const auto& [path, content] : before)
    if (!now.contains(path)) changes.push_back(path + " is gone");
}

/// Compares version, settings and inputs of a step.
std::vector<std::string> causes(const StepRecord& before, const StepRecord& now) {
  std::vector<std::string> changes;
  if (before.version != now.version)
    changes.push_back(fmt::format("palpate was {}, is {}", before.version, now.version));
  compare_entries(before.entries, now.entries, changes);
  compare_files(before.inputs, now.inputs, changes);
  return changes;
}

/// "rig.yaml changed, and 3 more changes"
std::string changes_in_words(const std::vector<std::string>& changes) {
  const std::size_t more = changes.size() - 1;
  if (more == 0) return changes.front();
  return fmt::format("{}, and {}", changes.front(), counted(more, "more change"));
}

/// \throws InvalidInput if a campaign is to be done again whose measurements are there.
void check_measurements(const StepCall& call, const StepRecord* before, const StepRecord& now,
                        const Fingerprints& there, const std::string& reason) {
  if (!call.step->measures || there.empty()) return;
  if (before != nullptr && can_be_resumed(*before, now)) return;
  throw InvalidInput(fmt::format(
      "{}: holds measurements, which are never replaced, but step '{}' is due ({}). Nothing was "
      "changed. Rename it, or undo the change; to keep its measurements, leave out the section "
      "and name it in section fit (acquisition).",
      there.begin()->first, call.step->name, reason));
}

StepPlan plan_with(const StepCall& call, const StepRecord* before, const StepRecord& now,
                   const std::optional<std::string>& awaited) {
  const Fingerprints there = fingerprints_of(call.outputs);
  StepPlan plan;
  const std::vector<std::string> changes = before == nullptr
                                               ? std::vector<std::string>{"not done before"}
                                               : changes_since(*before, now, there);
  if (!changes.empty())
    plan = {.need = StepNeed::due, .reason = changes_in_words(changes)};
  else if (awaited)
    plan = {.need = StepNeed::depends, .reason = "if " + *awaited + " writes something else"};
  if (plan.need != StepNeed::none) check_own(call.step->name, before, there);
  if (plan.need == StepNeed::due) check_measurements(call, before, now, there, plan.reason);
  return plan;
}

bool is_of(const fs::path& path, const StepCall& call) {
  return std::ranges::any_of(call.outputs,
                             [&](const fs::path& output) { return lies_in(path, output); });
}

/// Leaves out inputs that a step is going to write.
void forget(Fingerprints& inputs, const StepCall& writer) {
  std::erase_if(inputs, [&](const auto& input) { return is_of(input.first, writer); });
}

}  // namespace

Fingerprints fingerprints_of(const std::vector<fs::path>& paths) {
  Fingerprints files;
  for (const fs::path& path : paths) {
    if (!is_there(path)) continue;
    if (is_folder(path)) {
      add_folder(path, files);
      continue;
    }
    add_file(path, files);
    for (const fs::path& beside : files_beside(path))
      if (is_there(beside)) add_file(beside, files);
  }
  return files;
}

std::vector<std::string> changes_since(const StepRecord& before, const StepRecord& now,
                                       const Fingerprints& there) {
  std::vector<std::string> changes = causes(before, now);
  if (before.state != StepState::done) {
    changes.insert(changes.begin(), "it did not finish");
    return changes;
  }
  for (const auto& [path, content] : before.outputs) {
    const auto found = there.find(path);
    if (found == there.end())
      changes.push_back(path + " is missing");
    else if (found->second != content)
      changes.push_back(path + " is not as it was written");
  }
  return changes;
}

bool can_be_resumed(const StepRecord& before, const StepRecord& now) {
  return before.state != StepState::done && causes(before, now).empty();
}

void check_own(const std::string& step, const StepRecord* before, const Fingerprints& there) {
  const auto refuse = [&](const std::string& path, const char* reason) {
    throw InvalidInput(fmt::format(
        "{}: {}, and step '{}' would replace it. Nothing was changed. Rename it, and name it in "
        "the sections that are to read it; or remove it, to have it made again.",
        path, reason, step));
  };
  const auto is_being_written = [&](const std::string& path) {
    return before != nullptr && before->state == StepState::begun &&
           std::ranges::any_of(before->writes,
                               [&](const std::string& output) { return lies_in(path, output); });
  };
  for (const auto& [path, content] : there) {
    if (is_being_written(path)) continue;
    if (before == nullptr || !before->outputs.contains(path))
      refuse(path, "is there, but palpate run did not write it");
    if (before->outputs.at(path) != content) refuse(path, "was changed after palpate run wrote it");
  }
}

StepRecord now_of(const StepCall& call) {
  StepRecord now{.version = PALPATE_VERSION,
                 .entries = in_utf8(call.entries),
                 .inputs = fingerprints_of(call.inputs)};
  for (const fs::path& output : call.outputs)
    now.writes.push_back(in_utf8(output.generic_string()));
  return now;
}

StepPlan plan_step(const StepCall& call, const StepRecord* before, const StepRecord& now) {
  return plan_with(call, before, now, std::nullopt);
}

std::vector<StepPlan> plan_steps(const std::vector<StepCall>& calls, const ProjectRecord& record) {
  std::vector<StepPlan> plans;
  std::vector<const StepCall*> writers;  // of what may change
  for (const StepCall& call : calls) {
    StepRecord now = now_of(call);
    const StepRecord* const known = record.find(call.step->name);
    std::optional<StepRecord> before;
    if (known != nullptr) before = *known;
    std::optional<std::string> awaited;
    for (const StepCall* writer : writers) {
      const bool reads = std::ranges::any_of(
          call.inputs, [&](const fs::path& input) { return is_of(input, *writer); });
      if (!reads) continue;
      awaited = writer->step->name;
      forget(now.inputs, *writer);
      if (before) forget(before->inputs, *writer);
    }
    plans.push_back(plan_with(call, before ? &*before : nullptr, now, awaited));
    if (plans.back().need != StepNeed::none) writers.push_back(&call);
  }
  return plans;
}

}  // namespace palpate::apps
