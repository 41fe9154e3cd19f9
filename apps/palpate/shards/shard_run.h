// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "shards/shard.h"
#include "shards/shard_journal.h"
#include "shared/command_line.h"
#include "shared/result_folder.h"

namespace palpate::apps {

/// The journal of a shard, if it is finished: its settings are those of the call, and its inputs
/// and outputs are as the journal says. The current directory must be that of the call.
[[nodiscard]] std::optional<ShardJournal> finished_shard(const ShardCall& call, const Shard& shard);

/// Writes the results of one shard into a folder that all shards share.
///
/// A shard writes only the files of its own items, each as a whole, and at its end its journal.
/// What all shards have in common is written by the first one, and again by those that start at the
/// same time, with the same settings. So shards may run in any order, at once, and twice at once.
class ShardRun {
 public:
  /// Lists results in the folder that are not those of shards.
  using List = std::function<std::vector<fs::path>(const fs::path&)>;

  /// \param call the call of this shard.
  /// \param write_common writes what all shards have in common; called by the first shard only.
  /// \throws InvalidInput if the folder holds results of another run, or shards of another call,
  /// other items or another version; nothing was written then.
  /// \throws OutputError if a run that is no shard writes into the folder.
  ShardRun(const ShardCall& call, const Shard& shard, const List& list,
           const std::function<void()>& write_common);

  /// True if an earlier run has finished this shard, and its inputs and outputs are unchanged.
  [[nodiscard]] bool is_finished() const { return finished_; }

  /// Adds an item. In the order of the items.
  void add(ShardItem item) { journal_.items.push_back(std::move(item)); }

  /// Writes the journal, after all items.
  /// \throws OutputError if it cannot be written.
  void finish();

  /// Prints what became of the shard.
  /// \param items what the items are: "frame".
  void report(const Settings& settings, const std::string& items) const;

 private:
  ShardCall call_;
  std::optional<FolderLock> lock_;
  std::chrono::steady_clock::time_point start_;
  ShardJournal journal_;
  bool finished_ = false;
};

}  // namespace palpate::apps
