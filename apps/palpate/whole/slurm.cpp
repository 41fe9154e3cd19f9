// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/slurm.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <system_error>
#include <thread>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "shared/child_process.h"
#include "shared/inputs.h"
#include "shared/interrupts.h"
#include "shared/program.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

using std::chrono::milliseconds;

// Between two looks at the queue: short jobs end at once, and many calls of squeue are a burden.
constexpr milliseconds kFirstWait{200}, kLongestWait{30'000};

constexpr const char* kTemplateVariable = "PALPATE_TEMPLATE";

fs::path cluster_file(const char* name) {
  return bundled(PALPATE_INSTALLED_CLUSTER, PALPATE_SOURCE_CLUSTER) / name;
}

/// The last line of a text that is not empty.
std::string last_line_of(const std::string& text) {
  std::istringstream lines(text);
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  return last;
}

/// \throws InvalidInput if a program of Slurm cannot be run.
void check_program(const std::string& program) {
  std::string reason;
  try {
    const ChildResult version = run_child({program, "--version"});
    if (version.status == 0) return;
    reason = fmt::format("{} --version: {}.", program, last_line_of(version.err));
  } catch (const OutputError& error) {
    reason = error.what();
  }
  throw InvalidInput(fmt::format(
      "--executor slurm: {} Call this on a computer that can submit jobs to Slurm; or leave out "
      "--executor, and the shards are done on this computer.",
      reason));
}

/// Sleeps, but not after Ctrl-C.
void wait_awake(milliseconds time) {
  constexpr milliseconds kNap{50};
  for (milliseconds waited{0}; waited < time; waited += kNap) {
    InterruptedByThrowing::check();
    std::this_thread::sleep_for(kNap);
  }
}

}  // namespace

fs::path check_slurm() {
  check_program("sbatch");
  check_program("squeue");
  const char* const given = std::getenv(kTemplateVariable);
  if (given == nullptr) return cluster_file("slurm.sh");
  if (std::error_code ignored; !fs::is_regular_file(given, ignored)) {
    throw InvalidInput(
        fmt::format("{}: is {}, which is no file. Name a copy of cluster/slurm.sh that is edited "
                    "for your site, or unset the variable.",
                    kTemplateVariable, given));
  }
  return fs::absolute(given);
}

std::vector<std::string> submit(const SlurmShards& shards) {
  std::vector<std::string> words = {"env",
                                    fmt::format("{}={}", kTemplateVariable, shards.job.string()),
                                    "PALPATE_LOGS=" + shards.logs.string(),
                                    "PALPATE_ONLY=" + in_ranges(shards.indices),
                                    cluster_file("submit.sh").string(),
                                    std::to_string(shards.count)};
  words.insert(words.end(), shards.command.begin(), shards.command.end());
  const ChildResult result = run_child(words);
  if (result.status != 0)
    throw Error("Slurm does not accept the shards: " + last_line_of(result.err));
  std::vector<std::string> jobs;
  std::istringstream numbers(last_line_of(result.out));
  for (std::string job; std::getline(numbers, job, ':');) jobs.push_back(job);
  return jobs;
}

std::optional<SlurmQueue> queue_of(const std::vector<std::string>& jobs) {
  SlurmQueue queue;
  if (jobs.empty()) return queue;
  std::string lines;
  try {
    // A job that has left the queue is an error if it is asked for by its number.
    const ChildResult result =
        run_child({"squeue", "--noheader", "--array", "--me", "--format=%F %K %t"});
    if (result.status != 0) return std::nullopt;
    lines = result.out;
  } catch (const OutputError&) {
    return std::nullopt;
  }
  std::istringstream entries(lines);
  for (std::string job, index, state; entries >> job >> index >> state;) {
    if (std::ranges::find(jobs, job) == jobs.end()) continue;
    const auto number = parse_number<int>(index);
    if (!number) return std::nullopt;  // no answer that is understood
    (state == "PD" ? queue.waiting : queue.running).push_back({job, *number});
  }
  return queue;
}

void wait_for_jobs(const std::vector<std::string>& jobs, const std::string& step, int count,
                   const std::function<int()>& finished) {
  Progress progress(step + " on Slurm");
  const InterruptMessage message(
      fmt::format("finished shards are kept; jobs {} of Slurm go on", fmt::join(jobs, " ")),
      fmt::format("to wait for them again, call palpate run again; to end them, call scancel {}",
                  fmt::join(jobs, " ")));
  bool is_warned = false;
  for (milliseconds wait = kFirstWait;; wait = std::min(wait * 3 / 2, kLongestWait)) {
    progress.show(finished(), count);
    const std::optional<SlurmQueue> queue = queue_of(jobs);
    if (queue && queue->running.empty() && queue->waiting.empty()) return;
    if (!queue && !is_warned) {
      spdlog::warn("squeue does not answer; the jobs of Slurm go on, and it is asked again.");
      is_warned = true;
    }
    wait_awake(wait);
  }
}

std::map<int, ShardLog> logs_of_shards(const fs::path& folder,
                                       const std::vector<std::string>& jobs) {
  std::map<int, ShardLog> logs;
  if (!is_there(folder)) return logs;
  const auto age = [&](const std::string& job) { return std::ranges::find(jobs, job); };
  const std::regex pattern(R"(palpate-([0-9]+)-([0-9]{1,9})\+([0-9]{1,9})\.log)");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    std::smatch parts;
    if (!std::regex_match(name, parts, pattern) || age(parts[1]) == jobs.end()) continue;
    const ShardLog log{.task = {.job = parts[1], .index = std::stoi(parts[3])},
                       .file = entry.path()};
    const auto [known, is_new] = logs.emplace(std::stoi(parts[2]) + log.task.index, log);
    if (!is_new && age(known->second.task.job) < age(log.task.job)) known->second = log;
  }
  return logs;
}

std::string last_line(const fs::path& log) {
  constexpr std::streamoff kEnd = 4096;  // bytes: progress may fill a log
  std::ifstream stream(log, std::ios::binary | std::ios::ate);
  if (const std::streamoff size = stream.tellg(); size > kEnd)
    stream.seekg(size - kEnd);
  else
    stream.seekg(0);
  std::ostringstream text;
  text << stream.rdbuf();
  return last_line_of(text.str());
}

std::string in_ranges(const std::vector<int>& indices) {
  std::vector<std::string> ranges;
  for (std::size_t first = 0, last = 0; first < indices.size(); first = last + 1) {
    last = first;
    while (last + 1 < indices.size() && indices[last + 1] == indices[last] + 1) ++last;
    ranges.push_back(last == first ? std::to_string(indices[first])
                                   : fmt::format("{}-{}", indices[first], indices[last]));
  }
  return fmt::format("{}", fmt::join(ranges, ","));
}

}  // namespace palpate::apps
