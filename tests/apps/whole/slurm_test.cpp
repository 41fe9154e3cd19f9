// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Functions that need no Slurm; run_shards_test.cpp submits to one that is played, tests/cluster to
// a real one.
#include "whole/slurm.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

TEST(Slurm, NamesShardsInRanges) {
  EXPECT_EQ(in_ranges({}), "");
  EXPECT_EQ(in_ranges({3}), "3");
  EXPECT_EQ(in_ranges({1, 2, 3, 5, 8, 9}), "1-3,5,8-9");
}

TEST(Slurm, FindsTheNewestLogOfEachShardAmongThoseOfItsJobs) {
  const ScratchFolder scratch;
  for (const char* name : {"palpate-98-0+7.log", "palpate-100-0+7.log", "palpate-99-1000+2.log",
                           "palpate-44-0+3.log", "notes.txt"})
    write_text(scratch / name, "");
  const std::map<int, ShardLog> logs = logs_of_shards(scratch.path(), {"98", "99", "100"});
  ASSERT_EQ(logs.size(), 2U);  // job 44 is of another run
  EXPECT_EQ(logs.at(7).file.filename(), "palpate-100-0+7.log");
  EXPECT_EQ(logs.at(1002).task, (SlurmTask{.job = "99", .index = 2}));
  EXPECT_TRUE(logs_of_shards(scratch / "missing", {"98"}).empty());
}

TEST(Slurm, ReadsTheLastLineOfALog) {
  const ScratchFolder scratch;
  write_text(scratch / "log", std::string(100'000, 'x') + "\nfirst\nlast\n\n  \n");
  EXPECT_EQ(last_line(scratch / "log"), "last");
  write_text(scratch / "log", "");
  EXPECT_EQ(last_line(scratch / "log"), "");
}

}  // namespace
}  // namespace palpate::apps
