// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shards/shard_merge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <system_error>

#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// "Make shard 3/7 again, in /home/me: palpate decode ... --shard 3/7"
std::string how_to_make(const ShardCall& call, const Shard& shard) {
  return fmt::format("in {}: {}", call.directory.string(), words_of(call, shard));
}

FileError changed(const ShardCall& call, const Shard& shard, const fs::path& file,
                  const std::string& what) {
  return FileError(fmt::format("{}: {} since shard {} was finished. Make it again, {}",
                               file.string(), what, to_string(shard), how_to_make(call, shard)));
}

/// Checks the files of an item.
void check_files(const ShardCall& call, const Shard& shard, const ShardItem& item, bool verify) {
  for (const ShardFile& output : item.outputs) {
    const fs::path file = call.output / output.path;
    std::error_code missing;
    const std::uintmax_t bytes = fs::file_size(file, missing);
    if (missing) throw changed(call, shard, file, "was removed");
    if (bytes != output.bytes || (verify && file_fingerprint(file) != output.digest))
      throw changed(call, shard, file, "was changed");
  }
  if (!verify) return;
  for (const ShardFile& input : item.inputs) {
    const fs::path file = call.directory / input.path;
    if (file_fingerprint(file) != input.digest) throw changed(call, shard, file, "was changed");
  }
}

/// \throws FileError unless the items are those of the shard's block.
void check_block(const ShardCall& call, const ShardJournal& journal) {
  const ShardBlock block =
      block_of(journal.shard, call.settings.at("number of items").get<std::size_t>());
  std::size_t number = block.first;
  for (const ShardItem& item : journal.items) {
    if (item.number == number) ++number;
  }
  if (number == block.end && journal.items.size() == block.end - block.first) return;
  throw FileError(
      fmt::format("{}: does not list the {} items from {} on, one after the other. Make shard {} "
                  "again, {}",
                  journal_file(call.output, journal.shard).string(), block.end - block.first,
                  block.first, to_string(journal.shard), how_to_make(call, journal.shard)));
}

/// \throws Error that names the missing shards.
void tell_missing(const ShardCall& call, const std::vector<Shard>& missing, bool allow) {
  if (missing.empty()) return;
  std::vector<int> numbers(missing.size());
  std::ranges::transform(missing, numbers.begin(), &Shard::index);
  const int all = missing.front().count;
  const std::string words =
      fmt::format("{}: {} of {} shards {} missing: {}", call.output.string(), missing.size(), all,
                  missing.size() == 1 ? "is" : "are", fmt::join(numbers, ","));
  if (allow && static_cast<int>(missing.size()) < all)
    return spdlog::warn("{}; the results are those of the others", words);
  throw Error(fmt::format("{}. Make shard {}, {}", words, missing.front().index,
                          how_to_make(call, missing.front())));
}

}  // namespace

MergedShards read_shards(const ShardCall& call, const ShardMergeOptions& options,
                         const std::function<void(ShardItem&)>& take) {
  MergedShards merged;
  const int count = call.settings.at("number of shards");
  Progress progress("merging");
  for (int index = 1; index <= count; ++index) {
    const Shard shard{.index = index, .count = count};
    std::optional<ShardJournal> journal = read_journal(call.output, shard);
    if (!journal) {
      merged.missing.push_back(shard);
      continue;
    }
    check_same_shards(journal_file(call.output, shard), call.settings, journal->settings);
    check_block(call, *journal);
    merged.seconds += journal->seconds;
    for (ShardItem& item : journal->items) {
      check_files(call, shard, item, options.verify);
      take(item);
    }
    progress.show(index, count);
  }
  tell_missing(call, merged.missing, options.allow_missing);
  return merged;
}

}  // namespace palpate::apps
