// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shards/shard.h"
#include "shards/shard_merge.h"
#include "shared/command_line.h"
#include "surfaces/mesh_steps.h"

namespace palpate::apps {

/// A call of `mesh`.
struct MeshCall {
  std::vector<fs::path> inputs;
  fs::path output, picture;
  std::vector<fs::path> still;  ///< frames for `MeshSteps::noise`
  std::string format = "ply";   ///< of the meshes of a sequence
  std::optional<Shard> shard;   ///< of a sequence
  MeshSteps steps;
};

/// Meshes a sequence of range maps or depth images, or those of a shard, and reports them. One that
/// cannot be meshed is reported and skipped.
/// \throws FileError if none can be meshed.
/// \throws Error if some cannot be meshed, after the others.
void mesh_sequence(const Settings& settings, const CLI::App& command, const MeshCall& call);

/// Merges the shards of a sequence: prints the same as `mesh` without --shard.
/// \throws as `read_shards` and `mesh_sequence`.
void merge_mesh_shards(const Settings& settings, const ShardCall& call,
                       const ShardMergeOptions& options);

}  // namespace palpate::apps
