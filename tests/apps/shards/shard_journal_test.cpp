// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shards/shard_journal.h"

#include <gtest/gtest.h>

#include <string>

#include "palpate/core/error.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

constexpr Shard kSecondOfThree{.index = 2, .count = 3};

ShardJournal journal_of_two() {
  ShardJournal journal{.shard = kSecondOfThree,
                       .settings = {{"version", "1"}},
                       .host = "here",
                       .start = "2026-11-28T17:03:12Z",
                       .end = "2026-11-28T17:04:12Z",
                       .seconds = 60,
                       .peak_memory = 1 << 20,
                       .restarts = 2,
                       .items = {}};
  journal.items.push_back({.number = 4,
                           .name = "4.png",
                           .error = {},
                           .inputs = {{"frames/4.png", 12, 77, "abc"}},
                           .outputs = {{"000004.tiff", 13, 0, "def"}},
                           .result = {{"depth", 0.1}}});
  journal.items.push_back({.number = 5,
                           .name = "5.png",
                           .error = "is broken",
                           .inputs = {},
                           .outputs = {},
                           .result = {}});
  return journal;
}

TEST(ShardJournal, IsReadAsItWasWritten) {
  const ScratchFolder scratch;
  write_journal(scratch.path(), journal_of_two());
  EXPECT_EQ(read_journal(scratch.path(), {.index = 1, .count = 3}), std::nullopt);
  const std::optional<ShardJournal> read = read_journal(scratch.path(), kSecondOfThree);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->host, "here");
  EXPECT_EQ(read->peak_memory, 1U << 20);
  EXPECT_EQ(read->restarts, 2);
  ASSERT_EQ(read->items.size(), 2U);
  EXPECT_EQ(read->items[0].result.at("depth"), 0.1);
  EXPECT_EQ(read->items[0].inputs.at(0).modified, 77);
  EXPECT_EQ(read->items[0].outputs.at(0).digest, "def");
  EXPECT_EQ(read->items[1].error, "is broken");
}

TEST(ShardJournal, IsRefusedWhereverItIsCutOff) {
  const ScratchFolder scratch;
  write_journal(scratch.path(), journal_of_two());
  const std::string file = journal_file(scratch.path(), kSecondOfThree);
  const std::string whole = read_text(file);
  for (std::size_t bytes = 0; bytes < whole.size(); bytes += 7) {
    write_text(file, whole.substr(0, bytes));
    EXPECT_THROW((void)read_journal(scratch.path(), kSecondOfThree), FileError) << bytes;
  }
}

TEST(ShardJournal, OfAnotherShardIsRefused) {
  const ScratchFolder scratch;
  write_journal(scratch.path(), journal_of_two());
  const Shard third{.index = 3, .count = 3};
  std::filesystem::rename(journal_file(scratch.path(), kSecondOfThree),
                          journal_file(scratch.path(), third));
  EXPECT_THROW((void)read_journal(scratch.path(), third), FileError);
}

TEST(ShardJournal, MeasuresTheFileThatIsThere) {
  const ScratchFolder scratch;
  write_text(scratch / "a", "one");
  const ShardFile before = measured(scratch / "a", scratch.path());
  EXPECT_EQ(before.path, "a");
  EXPECT_EQ(before.bytes, 3U);
  write_text(scratch / "a", "two");
  EXPECT_NE(measured(scratch / "a", scratch.path()).digest, before.digest);
  EXPECT_THROW((void)measured(scratch / "b"), FileError);
}

}  // namespace
}  // namespace palpate::apps
