// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "shared/aliases.h"

namespace palpate::apps {

/// One part of the items that a command works on, so that several processes share them: --shard
/// 3/7.
struct Shard {
  int index = 1;  ///< in [1, count]
  int count = 1;
};

/// "3/7"
[[nodiscard]] std::string to_string(const Shard& shard);

/// The items first to end - 1 of a list, from 0.
struct ShardBlock {
  std::size_t first = 0, end = 0;
};

/// The block of a shard: from item items * (index - 1) / count to, without it, items * index /
/// count, both rounded down. Blocks differ by at most one item; with more shards than items some
/// are empty.
[[nodiscard]] ShardBlock block_of(const Shard& shard, std::size_t items);

/// Adds the option --shard i/n.
CLI::Option* add_shard_option(CLI::App& command, std::optional<Shard>& shard);

/// A call of a command, without its --shard: what all shards of a folder have in common.
// NOLINTNEXTLINE(bugprone-exception-escape): JSON is moved without throwing.
struct ShardCall {
  std::string command;  ///< "decode"
  std::string words;    ///< as typed in a shell: "palpate decode frames/ -o range"
  fs::path directory;   ///< in which it was typed
  fs::path output;      ///< the folder of the results
  /// What the results depend on besides the items: the number of shards, the list of the items, the
  /// version, and the options by their names, with fingerprints of the files that they name.
  Json settings;
  Json record = {};  ///< further data that the command needs to merge shards
};

/// Describes a call that was parsed.
/// \param output the folder of the results.
/// \param items the items in their order; only their names count, not their folders.
[[nodiscard]] ShardCall shard_call(const CLI::App& command, const fs::path& output,
                                   const Shard& shard, std::span<const fs::path> items);

/// The call of one shard, to be typed in a shell, in its directory.
[[nodiscard]] std::string words_of(const ShardCall& call, const Shard& shard);

}  // namespace palpate::apps
