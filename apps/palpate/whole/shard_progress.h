// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shared/aliases.h"
#include "whole/project_record.h"
#include "whole/run_calls.h"
#include "whole/slurm.h"

namespace palpate::apps {

/// Progress of the shards of an unfinished step.
struct ShardProgress {
  int count = 0;
  std::vector<int> missing = {};         ///< those that are not finished
  std::optional<SlurmQueue> queue = {};  ///< nullopt without jobs, or if Slurm does not answer
  /// Those missing that have a log of Slurm, but are not in its queue any more; and these logs.
  std::vector<int> failed = {};
  std::vector<fs::path> logs = {};
  int restarts = 0;  ///< number of times that Slurm requeued finished shards
  /// Items per second of one process, over the finished shards; nullopt if these had no items.
  std::optional<double> rate = {};
  /// In which the processes that are at work, or a single one, do the missing shards.
  std::optional<double> seconds_left = {};
};

/// Reads the journals of a step, and looks into the queue of Slurm if it has jobs there.
/// \param record of a step that was begun with shards.
/// \param logs as in `ShardOptions`.
/// \throws FileError if the file of what the shards have in common is damaged.
[[nodiscard]] ShardProgress shard_progress(const StepCall& call, const StepRecord& record,
                                           const fs::path& logs);

/// "1 of 3 shards finished; missing: 2-3; 1.2 items/s, 12 s left"
[[nodiscard]] std::string in_words(const ShardProgress& progress);

[[nodiscard]] Json json_of(const ShardProgress& progress);

}  // namespace palpate::apps
