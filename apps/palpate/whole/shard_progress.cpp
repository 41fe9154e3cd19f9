// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/shard_progress.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>

#include "shards/shard_journal.h"
#include "shards/shard_run.h"
#include "shared/command_line.h"
#include "shared/progress.h"
#include "shared/result_folder.h"

namespace palpate::apps {
namespace {

void add_journals(const fs::path& place, ShardProgress& progress) {
  const std::optional<ShardCall> shared = read_call(place);
  std::size_t items = 0;
  double seconds = 0;
  for (int index = 1; index <= progress.count; ++index) {
    const Shard shard{.index = index, .count = progress.count};
    const auto journal = shared ? finished_shard(*shared, shard) : std::nullopt;
    if (!journal) {
      progress.missing.push_back(index);
      continue;
    }
    items += journal->items.size();
    seconds += journal->seconds;
    progress.restarts += journal->restarts;
  }
  if (items == 0 || !(seconds > 0)) return;
  const std::size_t all = shared->settings.at("number of items");
  progress.rate = static_cast<double>(items) / seconds;
  progress.seconds_left = static_cast<double>(all - items) / *progress.rate;
}

void add_queue(const StepRecord& record, const fs::path& logs, ShardProgress& progress) {
  const bool has_ended = record.state != StepState::begun;
  progress.queue = has_ended ? SlurmQueue() : queue_of(record.jobs);
  if (!progress.queue) return;
  const auto& [running, waiting] = *progress.queue;
  if (progress.seconds_left && !running.empty())
    *progress.seconds_left /= static_cast<double>(running.size());
  const std::map<int, ShardLog> all = logs_of_shards(logs, record.jobs);
  for (const int index : progress.missing) {
    const auto log = all.find(index);
    if (log == all.end()) continue;
    const auto has_it = [&](const std::vector<SlurmTask>& tasks) {
      return std::ranges::find(tasks, log->second.task) != tasks.end();
    };
    if (has_it(running) || has_it(waiting)) continue;
    progress.failed.push_back(index);
    progress.logs.push_back(log->second.file);
  }
}

}  // namespace

ShardProgress shard_progress(const StepCall& call, const StepRecord& record, const fs::path& logs) {
  ShardProgress progress{.count = record.shards};
  add_journals(unfinished_place(call.outputs.front()), progress);
  if (!record.jobs.empty()) add_queue(record, logs / call.step->name, progress);
  return progress;
}

std::string in_words(const ShardProgress& progress) {
  std::string words =
      fmt::format("{} of {} shards finished",
                  progress.count - static_cast<int>(progress.missing.size()), progress.count);
  if (!progress.missing.empty()) words += "; missing: " + in_ranges(progress.missing);
  if (progress.queue) {
    words += fmt::format("; on Slurm {} running, {} waiting", progress.queue->running.size(),
                         progress.queue->waiting.size());
  }
  if (!progress.failed.empty()) {
    words += fmt::format(", {} failed: {} ({})", progress.failed.size(), in_ranges(progress.failed),
                         progress.logs.front().string());
  }
  if (progress.restarts > 0) words += fmt::format("; {} queued again", progress.restarts);
  if (progress.rate) words += fmt::format("; {:.3g} items/s of a process", *progress.rate);
  if (progress.seconds_left && !progress.missing.empty())
    words += time_left(*progress.seconds_left);
  return words;
}

Json json_of(const ShardProgress& progress) {
  Json logs = Json::array();
  for (const fs::path& log : progress.logs) logs.push_back(log.string());
  const auto number_of = [&](const std::vector<SlurmTask> SlurmQueue::*tasks) {
    return progress.queue ? Json((*progress.queue.*tasks).size()) : Json();
  };
  return {{"number", progress.count},
          {"missing", progress.missing},
          {"running", number_of(&SlurmQueue::running)},
          {"waiting", number_of(&SlurmQueue::waiting)},
          {"failed", progress.failed},
          {"logs", logs},
          {"restarts", progress.restarts},
          {"items_per_second", number_or_null(progress.rate)},
          {"seconds_left", number_or_null(progress.seconds_left)}};
}

}  // namespace palpate::apps
