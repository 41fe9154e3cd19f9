// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shards/shard.h"

namespace palpate::apps {

/// A file that an item was made of, or that was written for it.
struct ShardFile {
  std::string path;  ///< of an input as the command found it, of an output in the folder
  std::uintmax_t bytes = 0;
  std::int64_t modified = 0;  ///< of an input: when it was last written, on the clock of its disk
  std::string digest;         ///< fingerprint of the content
};

/// Measures a file as it is now.
/// \param folder relative to which the path is noted; empty: as it is.
/// \throws FileError if it is not there.
[[nodiscard]] ShardFile measured(const fs::path& file, const fs::path& folder = {});

/// An item that a shard has finished.
// NOLINTNEXTLINE(bugprone-exception-escape): JSON is moved without throwing.
struct ShardItem {
  std::size_t number = 0;  ///< in the list of all items, from 0
  std::string name;
  std::string error;  ///< reason if there is no result; empty if there is one
  std::vector<ShardFile> inputs, outputs;
  Json result;  ///< the figures of the command
};

/// The work of a shard, with place and time.
// NOLINTNEXTLINE(bugprone-exception-escape): JSON is moved without throwing.
struct ShardJournal {
  Shard shard;
  Json settings;                   ///< see ShardCall
  std::string host, start, end;    ///< times in UTC, "2026-11-28T17:03:12Z", of the host's clock
  double seconds = 0;              ///< from start to end
  std::uintmax_t peak_memory = 0;  ///< [bytes] of the process
  int restarts = 0;                ///< number of times that Slurm queued its job again
  std::vector<ShardItem> items;
};

/// The files of the shards in a folder of results, relative to it: those of an earlier sharded run,
/// which another run into this folder replaces.
[[nodiscard]] std::vector<fs::path> shard_files(const fs::path& folder);

/// folder/shards/0003-of-0007.jsonl
[[nodiscard]] fs::path journal_file(const fs::path& folder, const Shard& shard);

/// Writes a journal as a whole.
/// \throws OutputError if the disk is full.
void write_journal(const fs::path& folder, const ShardJournal& journal);

/// Reads the journal of a shard; nullopt if it is not there.
/// \throws FileError if it was cut off, or is none of this shard.
[[nodiscard]] std::optional<ShardJournal> read_journal(const fs::path& folder, const Shard& shard);

/// \throws InvalidInput if shards have other settings than those in `file`, naming the first one.
void check_same_shards(const fs::path& file, const Json& before, Json now);

/// folder/shards/call.json
[[nodiscard]] fs::path call_file(const fs::path& folder);

/// Writes down, in the folder of the results, what all shards have in common.
void write_call(const ShardCall& call);

/// Reads what the first shard has written; nullopt if no shard was started in this folder.
/// \throws FileError if the file is damaged.
[[nodiscard]] std::optional<ShardCall> read_call(const fs::path& folder);

}  // namespace palpate::apps
