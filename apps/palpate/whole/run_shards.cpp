// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/run_shards.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "shards/shard_journal.h"
#include "shards/shard_run.h"
#include "shared/inputs.h"
#include "shared/interrupts.h"
#include "shared/program.h"
#include "shared/result_folder.h"
#include "whole/slurm.h"

namespace palpate::apps {
namespace {

/// A step whose work is divided.
struct ShardedStep {
  const StepCall& call;
  int count = 1;
  fs::path folder;  ///< of the results
  fs::path place;   ///< into which the shards write: the folder, or a hidden one in it
};

/// Files that a step with shards has written into a folder, relative to it.
std::vector<fs::path> results_in(const fs::path& folder) {
  std::vector<fs::path> results;
  for (auto at = fs::recursive_directory_iterator(folder); at != fs::recursive_directory_iterator();
       ++at) {
    const fs::path name = at->path().lexically_relative(folder);
    if (at->is_directory()) {
      if (is_hidden(name)) at.disable_recursion_pending();
      continue;
    }
    const bool is_of_others = name.extension() == ".jsonl" && name != "decode.jsonl" &&
                              name.parent_path() != call_file({}).parent_path();
    if (!is_hidden(name) && !is_of_others) results.push_back(name);
  }
  return results;
}

/// The call of a step that writes into another folder.
std::vector<std::string> words_into(const fs::path& place, const StepCall& call) {
  const std::string option = "--" + call.step->result_entry + "=";
  std::vector<std::string> words = call.words;
  std::ranges::replace(words, option + call.outputs.front().string(), option + place.string());
  return words;
}

/// The shards that are not finished.
std::vector<int> missing_shards(const ShardedStep& step) {
  // Looking into the folder also shows what other computers have written there.
  const bool is_begun = !shard_files(step.place).empty();
  const std::optional<ShardCall> shared = is_begun ? read_call(step.place) : std::nullopt;
  std::vector<int> missing;
  for (int index = 1; index <= step.count; ++index)
    if (!shared || !finished_shard(*shared, {.index = index, .count = step.count}))
      missing.push_back(index);
  return missing;
}

[[noreturn]] void refuse_failures(const ShardedStep& step, const std::vector<int>& failed,
                                  const std::string& where, const std::string& reason) {
  throw Error(fmt::format(
      "{}: {} of {} shards failed{}: {}. The others are kept; to do only these again, call palpate "
      "run again. Shard {}: {}",
      step.folder.string(), failed.size(), step.count, where, in_ranges(failed), failed.front(),
      reason));
}

void do_locally(const ShardedStep& step) {
  std::vector<int> failed;
  std::string reason;  // of the first one
  for (const int index : missing_shards(step)) {
    std::vector<std::string> words = words_into(step.place, step.call);
    words.push_back("--shard=" + to_string(Shard{.index = index, .count = step.count}));
    spdlog::info("palpate {}", fmt::join(words, " "));
    try {
      (void)run_call(words);
    } catch (const InvalidInput&) {
      throw;  // the others would be refused, too
    } catch (const Error& error) {
      if (failed.empty()) reason = error.what();
      failed.push_back(index);
    }
  }
  if (!failed.empty()) refuse_failures(step, failed, "", reason);
}

/// Number of shards that have a journal.
int count_journals(const fs::path& place) {
  const std::vector<fs::path> files = shard_files(place);
  return static_cast<int>(std::ranges::count(files, fs::path(".jsonl"), &fs::path::extension));
}

/// The reason for which a shard failed, as far as its log shows it.
std::string reason_of(int index, const fs::path& logs, const std::vector<std::string>& jobs) {
  const std::map<int, ShardLog> all = logs_of_shards(logs, jobs);
  const auto log = all.find(index);
  if (log == all.end()) {
    return fmt::format("it has no log in {}; sacct -j {} may tell what became of it", logs.string(),
                       fmt::join(jobs, ","));
  }
  return fmt::format("{} (the end of {})", last_line(log->second.file), log->second.file.string());
}

void wait_for(const ShardedStep& step, const std::vector<std::string>& jobs) {
  wait_for_jobs(jobs, step.call.step->name, step.count, [&] { return count_journals(step.place); });
}

void do_on_slurm(const ShardedStep& step, const ShardOptions& options,
                 const std::function<void(const std::vector<std::string>&)>& submitted) {
  const std::vector<int> missing = missing_shards(step);
  if (missing.empty()) return;
  SlurmShards shards{.command = words_into(step.place, step.call),
                     .count = step.count,
                     .indices = missing,
                     .job = options.job,
                     .logs = options.logs / step.call.step->name};
  shards.command.insert(shards.command.begin(), program_file().string());
  std::vector<std::string> jobs;
  {
    const InterruptedWithoutHaste until_jobs_are_kept;
    jobs = submit(shards);
    submitted(jobs);
  }
  spdlog::info("{}: {} shards are submitted to Slurm, jobs {}", step.call.step->name,
               missing.size(), fmt::join(jobs, " "));
  wait_for(step, jobs);
  const std::vector<int> failed = missing_shards(step);
  if (!failed.empty())
    refuse_failures(step, failed, " on Slurm", reason_of(failed.front(), shards.logs, jobs));
}

/// The folder into which the shards of a resumed run write. A run that was killed while it put its
/// results in their place is completed.
fs::path place_of_shards(const fs::path& folder) {
  return ResultFolder(folder, results_in, ResultFolder::Unfinished::resumed).place();
}

/// Puts the shards in the place of earlier results.
void put_in_place(const ShardedStep& step) {
  if (step.place == step.folder) return;
  if (std::optional<ShardCall> shared = read_call(step.place)) {
    const std::string inside = "/" + step.place.lexically_relative(step.folder).string();
    if (const auto at = shared->words.find(inside); at != std::string::npos)
      shared->words.erase(at, inside.size());
    write_call(*shared);
  }
  ResultFolder(step.folder, results_in, ResultFolder::Unfinished::resumed)
      .finish([](const fs::path&) { return true; });
}

}  // namespace

void check_no_jobs(const std::string& step, const StepRecord& before, const std::string& remedy) {
  if (before.state != StepState::begun) return;  // they were waited for
  const std::optional<SlurmQueue> queue = queue_of(before.jobs);
  if (queue && queue->running.empty() && queue->waiting.empty()) return;
  throw InvalidInput(fmt::format(
      "step '{}': an earlier run has submitted jobs to Slurm, and {}. Nothing was changed. {}, or "
      "end them: scancel {}",
      step, queue ? "they are still in its queue" : "squeue does not tell whether they have ended",
      remedy, fmt::join(before.jobs, " ")));
}

int count_shards(const StepCall& call, const StepRecord* before, std::optional<int> wanted) {
  const int begun = before != nullptr ? before->shards : 0;
  const auto may_have_jobs = [&] {
    return before->state == StepState::begun && !before->jobs.empty();
  };
  if (begun > 0 && (may_have_jobs() || read_call(unfinished_place(call.outputs.front())))) {
    if (!wanted || *wanted == begun) return begun;
    throw InvalidInput(fmt::format(
        "--shards: is {}, but step '{}' was begun with {} shards and did not finish. Give --shards "
        "{} to go on with them, or remove {} to begin again.",
        *wanted, call.step->name, begun, begun, call.outputs.front().string()));
  }
  if (!wanted || !call.takes_shard) return 0;
  const nlohmann::json& items = call.entries.at(call.step->items);
  const bool is_one = items.size() == 1 && items.front().size() == 1;
  const bool is_file = is_one && !is_folder(items.front().front().get<std::string>());
  return is_file ? 0 : *wanted;
}

void begin_shards(const StepCall& call) {
  ResultFolder(call.outputs.front(), results_in, ResultFolder::Unfinished::kept).begin();
}

void drop_shards(const StepCall& call, int count) {
  const fs::path& folder = call.outputs.front();
  if (!is_there(folder) || unfinished_place(folder) != folder) return;
  if (count_journals(folder) == count) return;
  const FolderLock lock(folder);
  for (const fs::path& result : results_in(folder)) fs::remove(folder / result);
}

Json do_shards(const StepCall& call, int count, const ShardOptions& options,
               const std::vector<std::string>& jobs,
               const std::function<void(const std::vector<std::string>& jobs)>& submitted) {
  const fs::path& folder = call.outputs.front();
  ShardedStep step{
      .call = call, .count = count, .folder = folder, .place = unfinished_place(folder)};
  if (!jobs.empty()) wait_for(step, jobs);
  step.place = place_of_shards(folder);
  if (options.executor == ShardExecutor::slurm)
    do_on_slurm(step, options, submitted);
  else
    do_locally(step);
  put_in_place(step);
  return run_call({"merge-shards", folder.string()});
}

}  // namespace palpate::apps
