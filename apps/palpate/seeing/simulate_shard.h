// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "seeing/simulate_shots.h"
#include "shards/shard.h"
#include "shards/shard_merge.h"
#include "shared/command_line.h"

namespace palpate::apps {

/// Simulates the frames of a shard, and prints the result. A shard whose frames are blurred
/// by the motion also reads the mesh after its last one.
/// \throws InvalidInput as `ShardRun`, and as `do_shot`.
void simulate_shard(const Settings& settings, const CLI::App& command, const SimulateCall& call,
                    const SimulateSetup& setup);

/// Merges the shards of `simulate`: prints the same as without --shard.
/// \throws as `read_shards`.
void merge_simulate_shards(const Settings& settings, const ShardCall& call,
                           const ShardMergeOptions& options);

}  // namespace palpate::apps
