// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "shared/aliases.h"
#include "whole/project_record.h"
#include "whole/run_calls.h"

namespace palpate::apps {

/// The place where shards run.
enum class ShardExecutor { local, slurm };

/// Options of `palpate run` for dividing the work of steps.
struct ShardOptions {
  std::optional<int>
      count;  ///< of shards; nothing: work that was not divided before is not divided
  ShardExecutor executor = ShardExecutor::local;
  fs::path job;   ///< of Slurm: the template of a job
  fs::path logs;  ///< of Slurm: with a folder for each step
};

/// Into how many shards the work of a step is divided; 0 if it is not. A step that goes on with
/// shards keeps their number.
/// \param before the record of the step, if it goes on; otherwise null.
/// \throws InvalidInput if another number is wanted.
[[nodiscard]] int count_shards(const StepCall& call, const StepRecord* before,
                               std::optional<int> wanted);

/// Checks that jobs of an earlier run do not write any more.
/// \param step its name, \param before its record.
/// \param remedy what to do instead of ending them.
/// \throws InvalidInput if they are in the queue of Slurm, or if it does not answer.
void check_no_jobs(const std::string& step, const StepRecord& before, const std::string& remedy);

/// Begins a step with shards. Results of an earlier run stay until all shards are finished.
/// \throws OutputError if another run writes into the folder of the results.
void begin_shards(const StepCall& call);

/// Removes the shards of a step that did not finish, which its command without --shard does not
/// replace. Results of which no shard is missing stay until then.
/// \param count their number.
void drop_shards(const StepCall& call, int count);

/// Does the shards that are missing, puts them in the place of earlier results, and merges them.
/// \param jobs of Slurm that were submitted before, and are waited for.
/// \param submitted is called with the jobs that are submitted now.
/// \return the figures that the step without shards would print with --json.
/// \throws Error that names the shards that failed, after the others.
Json do_shards(const StepCall& call, int count, const ShardOptions& options,
               const std::vector<std::string>& jobs,
               const std::function<void(const std::vector<std::string>& jobs)>& submitted);

}  // namespace palpate::apps
