// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shards/shard.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

TEST(Shard, BlocksFollowEachOtherAndDifferByOneItemAtMost) {
  for (const std::size_t items : {0UL, 1UL, 4UL, 10UL, 1'000'003UL, 100'000'000'000UL}) {
    for (const int count : {1, 2, 7, 1000}) {
      std::size_t end = 0;
      for (int index = 1; index <= count; ++index) {
        const ShardBlock block = block_of({.index = index, .count = count}, items);
        EXPECT_EQ(block.first, end);
        end = block.end;
        const std::size_t size = block.end - block.first, share = items / count;
        EXPECT_TRUE(size == share || size == share + 1) << index << '/' << count;
      }
      EXPECT_EQ(end, items);
    }
  }
}

/// A command as a program has it, of which the call is parsed.
struct ShardProgram {
  CLI::App app{"program", "palpate"};
  CLI::App* command = app.add_subcommand("decode");
  std::vector<std::string> frames;
  std::string output;
  std::vector<double> crop;
  bool sigma = false;
  std::optional<Shard> shard;

  explicit ShardProgram(std::vector<std::string> words) {
    command->add_option("FRAMES", frames);
    command->add_option("-o,--output", output);
    command->add_option("--crop", crop)->expected(3)->delimiter(',');
    command->add_flag("--sigma", sigma);
    add_shard_option(*command, shard);
    std::ranges::reverse(words);  // as CLI11 wants them
    app.parse(words);
  }

  ShardCall call(const std::vector<fs::path>& items) const {
    return shard_call(*command, output, *shard, items);
  }
};

const std::vector<std::string> kShardWords = {"decode", "it's/", "--sigma", "-o", "range",
                                              "--crop", "1,2,3", "--shard", "2/3"};

TEST(Shard, CallIsTypedAgainWithAnotherShard) {
  const ShardProgram program(kShardWords);
  EXPECT_EQ(words_of(program.call({}), {.index = 3, .count = 3}),
            R"(palpate decode 'it'\''s/' --output range --crop 1,2,3 --sigma --shard 3/3)");
}

TEST(Shard, CallDependsOnTheNamesOfItemsButNotOnPlaces) {
  const ShardProgram program(kShardWords);
  const ShardCall call = program.call({"a/0.png", "a/1.png"});
  std::vector<std::string> elsewhere = kShardWords;
  elsewhere[1] = "other/", elsewhere[4] = "results", elsewhere.back() = "1/3";
  EXPECT_EQ(call.settings, ShardProgram(elsewhere).call({"b/0.png", "b/1.png"}).settings);
  EXPECT_NE(call.settings, program.call({"a/0.png", "a/2.png"}).settings);
  EXPECT_NE(call.settings, program.call({"a/0.png"}).settings);
  std::vector<std::string> other = kShardWords;
  other.back() = "2/4";
  EXPECT_NE(call.settings, ShardProgram(other).call({"a/0.png", "a/1.png"}).settings);
}

TEST(Shard, OptionIsRefusedUnlessItIsAPart) {
  for (const char* wrong : {"0/3", "4/3", "3", "3/", "/3", "1/3x", "-1/3", "1/3/5", "a/b"}) {
    std::vector<std::string> words = kShardWords;
    words.back() = wrong;
    EXPECT_THROW(ShardProgram{words}, CLI::ValidationError) << wrong;
  }
}

}  // namespace
}  // namespace palpate::apps
