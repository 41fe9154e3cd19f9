// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "shards/shard_journal.h"

namespace palpate::apps {

struct ShardMergeOptions {
  bool allow_missing = false;  ///< merge the shards that are finished
  bool verify = false;         ///< also read all files and compare their digests
  bool force = false;          ///< accept results that the command doubts
};

/// The merged items.
struct MergedShards {
  std::vector<Shard> missing;
  double seconds = 0;  ///< that all shards took together
};

/// Checks the journals of all shards, and passes on their items in order.
/// \param call what all shards have in common, read from the folder.
/// \param take is called for each item; it must change nothing that stays if this function throws.
/// \throws Error that names the missing shards and the call that makes the first of them.
/// \throws FileError if a journal is cut off, or a file is not as its journal says.
/// \throws InvalidInput if a shard is of another call, other items or another version.
MergedShards read_shards(const ShardCall& call, const ShardMergeOptions& options,
                         const std::function<void(ShardItem&)>& take);

}  // namespace palpate::apps
