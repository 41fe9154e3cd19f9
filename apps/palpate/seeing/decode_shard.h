// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "palpate/sensing/decode.h"
#include "palpate/sensing/frame_source.h"
#include "seeing/decode_frames.h"
#include "shards/shard.h"
#include "shards/shard_merge.h"
#include "shared/command_line.h"

namespace palpate::apps {

/// The frames of which `decode --shard` decodes a part.
struct DecodeShardCall {
  const CLI::App& command;
  const sensing::Decoder& decoder;
  sensing::FrameSource& source;
  DecodeCall call;                         ///< with its shard
  nlohmann::ordered_json record_settings;  ///< everything that range maps depend on
  bool writes_rig = true;  ///< false: the rig of the call is already in the output folder
};

/// Decodes the frames of a shard, and prints the result.
/// \throws InvalidInput if there are videos among the frames, or as `ShardRun`.
void decode_shard(const Settings& settings, DecodeShardCall call);

/// Merges the shards of `decode`: writes the record and the table of all frames, judges them as one
/// sequence, and prints the same as `decode` without --shard.
/// \throws Error as `read_shards`, or if the frames do not fit, or if some could not be decoded.
void merge_decode_shards(const Settings& settings, const ShardCall& call,
                         const ShardMergeOptions& options);

}  // namespace palpate::apps
