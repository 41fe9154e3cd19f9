// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// Checks, before anything is done, that jobs can be submitted.
/// \return the template of a job: PALPATE_TEMPLATE in the environment, or cluster/slurm.sh.
/// \throws InvalidInput if this computer has no Slurm, or if there is no such template.
[[nodiscard]] fs::path check_slurm();

/// Shards that are submitted.
struct SlurmShards {
  std::vector<std::string> command;  ///< with its program, without --shard
  int count = 1;                     ///< of all shards
  std::vector<int> indices;          ///< of those to do, in ascending order
  fs::path job;                      ///< template of a job
  fs::path logs;                     ///< folder for their messages
};

/// Submits shards by cluster/submit.sh, which takes further settings from the environment. They run
/// in the current directory.
/// \return the numbers of the jobs, which are arrays.
/// \throws Error with the words of Slurm if it refuses them.
[[nodiscard]] std::vector<std::string> submit(const SlurmShards& shards);

/// A part of a job, which does one shard.
struct SlurmTask {
  std::string job;
  int index = 0;  ///< in its array
  friend bool operator==(const SlurmTask&, const SlurmTask&) = default;
};

/// Content of the queue of Slurm.
struct SlurmQueue {
  std::vector<SlurmTask> running = {}, waiting = {};
};

/// Looks for jobs in the queue.
/// \return nullopt if Slurm does not answer, or if this computer has none.
[[nodiscard]] std::optional<SlurmQueue> queue_of(const std::vector<std::string>& jobs);

/// Waits, with progress, until jobs have left the queue.
/// \param step what they do, \param count how many shards it has in all.
/// \param finished tells how many shards are finished.
/// \throws Interrupted after Ctrl-C; the jobs go on.
void wait_for_jobs(const std::vector<std::string>& jobs, const std::string& step, int count,
                   const std::function<int()>& finished);

/// Output that a shard has printed.
struct ShardLog {
  SlurmTask task;
  fs::path file;
};

/// The newest log of each shard that has one.
/// \param jobs whose logs are taken, in the order in which they were submitted.
[[nodiscard]] std::map<int, ShardLog> logs_of_shards(const fs::path& folder,
                                                     const std::vector<std::string>& jobs);

/// The last line of a log that is not empty.
[[nodiscard]] std::string last_line(const fs::path& log);

/// "1-4,9"
[[nodiscard]] std::string in_ranges(const std::vector<int>& indices);

}  // namespace palpate::apps
