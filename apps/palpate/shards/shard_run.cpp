// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shards/shard_run.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

std::string this_host() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

/// [bytes] Of this process, until now.
std::uintmax_t peak_memory() {
  struct rusage used {};
  ::getrusage(RUSAGE_SELF, &used);
  return static_cast<std::uintmax_t>(used.ru_maxrss) * 1024;
}

std::string utc_time() {
  const auto now = std::chrono::system_clock::now();
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
}

/// Returns true if a file has the size, and an input also the time, that a journal states.
bool is_as_it_was(const ShardFile& file, const fs::path& folder) {
  std::error_code missing;
  const fs::path path = folder / file.path;
  if (fs::file_size(path, missing) != file.bytes || missing) return false;
  return file.modified == 0 ||
         fs::last_write_time(path, missing).time_since_epoch().count() == file.modified;
}

bool is_as_it_was(const ShardItem& item, const fs::path& output) {
  if (item.inputs.empty()) return false;  // it was missing, and may be there now
  return std::ranges::all_of(item.inputs,
                             [](const auto& file) { return is_as_it_was(file, {}); }) &&
         std::ranges::all_of(item.outputs,
                             [&](const auto& file) { return is_as_it_was(file, output); });
}

/// \return whether shards of the same call are in the folder.
bool has_shards_of(const ShardCall& call) {
  const std::optional<ShardCall> before = read_call(call.output);
  if (!before) return false;
  const fs::path file = call_file(call.output);
  if (before->command != call.command) {
    throw InvalidInput(
        fmt::format("{}: the folder holds shards of palpate {}. Give another folder.",
                    file.string(), before->command));
  }
  check_same_shards(file, before->settings, call.settings);
  return true;
}

/// Number of times that Slurm has put the job of this process back into its queue.
int restarts() {
  const char* const text = std::getenv("SLURM_RESTART_COUNT");
  int count = 0;
  if (text != nullptr) std::from_chars(text, text + std::string_view(text).size(), count);
  return count;
}

}  // namespace

std::optional<ShardJournal> finished_shard(const ShardCall& call, const Shard& shard) {
  try {
    std::optional<ShardJournal> journal = read_journal(call.output, shard);
    if (!journal || journal->settings != call.settings) return std::nullopt;
    const bool is_same = std::ranges::all_of(
        journal->items, [&](const ShardItem& item) { return is_as_it_was(item, call.output); });
    return is_same ? std::move(journal) : std::nullopt;
  } catch (const FileError& damaged) {
    spdlog::info("{} The shard must be done again.", damaged.what());
    return std::nullopt;
  }
}

ShardRun::ShardRun(const ShardCall& call, const Shard& shard, const List& list,
                   const std::function<void()>& write_common)
    : call_(call), start_(std::chrono::steady_clock::now()) {
  std::error_code failed;
  fs::create_directories(call.output, failed);
  lock_.emplace(call.output, FolderLock::With::others);
  journal_.shard = shard;
  journal_.settings = call.settings;
  journal_.start = utc_time();
  if (has_shards_of(call)) {
    if (std::optional<ShardJournal> before = finished_shard(call, shard)) {
      journal_ = std::move(*before);
      finished_ = true;
    }
    return;
  }
  // Another shard may write its first results between the two looks.
  if (const std::vector<fs::path> results = list(call.output);
      !results.empty() && !has_shards_of(call)) {
    throw InvalidInput(fmt::format(
        "{}: is a result of an earlier run, and shards do not replace results. Give a new or an "
        "empty folder.",
        (call.output / results.front()).string()));
  }
  write_common();
  write_call(call);
  (void)has_shards_of(call);  // of shards of two calls that begin at once, one is refused here
}

void ShardRun::finish() {
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start_;
  journal_.host = this_host();
  journal_.end = utc_time();
  journal_.seconds = taken.count();
  journal_.peak_memory = peak_memory();
  journal_.restarts = restarts();
  write_journal(call_.output, journal_);
}

void ShardRun::report(const Settings& settings, const std::string& items) const {
  const auto broken = std::ranges::count_if(
      journal_.items, [](const ShardItem& item) { return !item.error.empty(); });
  const fs::path file = journal_file(call_.output, journal_.shard);
  const std::size_t count = journal_.items.size();
  print(
      settings,
      {{"shard", to_string(journal_.shard)},
       {"items", count},
       {"broken", broken},
       {"kept", finished_},
       {"seconds", journal_.seconds},
       {"journal", file.string()}},
      fmt::format("Shard {} {}: {}{}, in {}", to_string(journal_.shard),
                  finished_ ? "was finished before" : "is finished", counted(count, items),
                  broken > 0 ? fmt::format(", of which {} could not be read or used", broken) : "",
                  file.string()));
}

}  // namespace palpate::apps
